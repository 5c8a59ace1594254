// The accumulation on disk: a header, the seeds, the pixels as they lie in memory, a checksum. Little-endian.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/image_io.h"
#include "loom/diagnostic.h"
#include "reference/film.h"

namespace loom::reference {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(std::is_trivially_copyable_v<PixelSums>);
static_assert(sizeof(PixelSums) == (3 * replicates + 15 + 1 + 2 + 3) * sizeof(double), "no padding goes to disk");

constexpr std::uint32_t version = 2;
/// Version 1 ended before `specular`, which is zero then.
constexpr std::size_t first_pixel_bytes = offsetof(PixelSums, specular);
constexpr std::uint64_t most_pixels = 1U << 28U;  // 16384²: what a header may ask for before memory is taken

struct Header {
  std::array<char, 8> magic{'L', 'O', 'O', 'M', 'F', 'I', 'L', 'M'};
  std::uint32_t version = reference::version;
  std::uint32_t pixel_bytes = sizeof(PixelSums);
  std::int32_t width = 0, height = 0;
  std::uint64_t scene = 0;
  std::int32_t bounces = 0;
  std::uint32_t seeds = 0;
  double seconds = 0;
  std::uint64_t rays = 0;
};
static_assert(sizeof(Header) == 56);

/// FNV-1a over 64-bit words (every block here is a multiple of 8 bytes): finds a torn or damaged file.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, &bytes[i], sizeof word);
    hash = (hash ^ word) * 0x100000001b3U;
  }
  return hash;
}

[[noreturn]] void damaged(const std::string& path, const std::string& why) {
  Diagnostic diagnostic;
  diagnostic.code = "film-damaged";
  diagnostic.message = "the accumulation '" + path + "' cannot be used: " + why;
  diagnostic.where.file = path;
  diagnostic.hint = "delete it to start again, or choose another -o";
  throw BadInput(diagnostic);
}

}  // namespace

void Film::save(const std::string& path) const {
  Header header;
  header.width = size_.x;
  header.height = size_.y;
  header.scene = identity_.scene;
  header.bounces = identity_.bounces;
  header.seeds = static_cast<std::uint32_t>(seeds_.size());
  header.seconds = seconds;
  header.rays = rays;
  std::vector<std::byte> bytes;
  bytes.reserve(sizeof header + 8 * seeds_.size() + sizeof(PixelSums) * pixels_.size() + 8);
  const auto append = [&](std::span<const std::byte> part) { bytes.insert(bytes.end(), part.begin(), part.end()); };
  append(std::as_bytes(std::span(&header, 1)));
  append(std::as_bytes(std::span(seeds_)));
  append(std::as_bytes(std::span(pixels_)));
  const std::uint64_t sum = checksum(bytes);
  append(std::as_bytes(std::span(&sum, 1)));
  write_file_atomic(path, bytes);
}

Film Film::load(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw BadInput("the accumulation '" + path + "' cannot be opened");
  Header header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) damaged(path, "it is too short");
  if (header.magic != Header{}.magic) damaged(path, "it is not one");
  const std::size_t pixel_bytes = header.version == 1 ? first_pixel_bytes : sizeof(PixelSums);
  if (header.version < 1 || header.version > version || header.pixel_bytes != pixel_bytes) {
    damaged(path,
            "it is of version " + std::to_string(header.version) + ", this program writes " + std::to_string(version));
  }
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(std::max(0, header.width)) * static_cast<std::uint64_t>(std::max(0, header.height));
  const std::uint64_t expected = sizeof header + 8ULL * header.seeds + pixel_bytes * pixels + 8;
  in.seekg(0, std::ios::end);
  if (pixels == 0 || pixels > most_pixels || static_cast<std::uint64_t>(in.tellg()) != expected) {
    damaged(path, "its length does not fit its header");
  }
  std::vector<std::byte> bytes(expected);
  in.seekg(0);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(expected))) {
    damaged(path, "it cannot be read");
  }
  const std::span<const std::byte> all(bytes);
  std::uint64_t sum = 0;
  std::memcpy(&sum, &bytes[expected - 8], 8);
  if (sum != checksum(all.first(expected - 8))) damaged(path, "its checksum is wrong");

  Film film({header.width, header.height}, {header.scene, header.bounces}, 0);
  film.seconds = header.seconds;
  film.rays = header.rays;
  film.seeds_.resize(header.seeds);
  std::memcpy(film.seeds_.data(), &bytes[sizeof header], 8 * film.seeds_.size());
  const std::byte* from = &bytes[sizeof header + 8 * film.seeds_.size()];
  for (PixelSums& sums : film.pixels_) {
    std::memcpy(&sums, from, pixel_bytes);
    from += pixel_bytes;
  }
  return film;
}

}  // namespace loom::reference
