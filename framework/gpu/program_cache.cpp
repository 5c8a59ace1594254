#include "gpu/program_cache.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "core/data_dir.h"
#include "core/image_io.h"
#include "core/log.h"
#include "gpu/hash.h"
#include "loom/diagnostic.h"

namespace loom::gpu {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_cache_bytes = 256u << 20;  // some thousand programs; the oldest go first

// File: header, then the driver's bytes.
struct Header {
  char magic[8];
  char key[32];       // of sources, defines and driver
  char checksum[32];  // of the bytes that follow
  std::uint64_t length;
  std::uint32_t format;
  std::uint32_t unused;
};
constexpr char magic[8] = {'L', 'O', 'O', 'M', 'P', 'R', 'G', '1'};

std::string checksum(std::span<const std::byte> bytes) { return Hash128().add(bytes).hex(); }

}  // namespace

ProgramCache::ProgramCache(const std::string& dir) {
  if (dir == "-") return;
  const fs::path path = dir.empty() ? cache_dir() : dir;
  if (path.empty()) return;
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    log().warn("no program cache: cannot make {} ({})", path.string(), error.message());
    return;
  }
  dir_ = path.string();
  trim();
}

std::string ProgramCache::path(const std::string& key) const { return (fs::path(dir_) / (key + ".glprog")).string(); }

std::optional<ProgramBinary> ProgramCache::load(const std::string& key) const {
  if (!enabled()) return std::nullopt;
  std::ifstream file(path(key), std::ios::binary);
  if (!file) return std::nullopt;
  const std::vector<char> content(std::istreambuf_iterator<char>(file), {});
  Header header{};
  if (content.size() < sizeof(header)) return std::nullopt;
  std::memcpy(&header, content.data(), sizeof(header));
  const std::span body = std::as_bytes(std::span(content)).subspan(sizeof(header));
  const bool good = std::memcmp(header.magic, magic, sizeof(magic)) == 0 &&
                    std::string_view(header.key, sizeof(header.key)) == key && header.length == body.size() &&
                    std::string_view(header.checksum, sizeof(header.checksum)) == checksum(body);
  if (!good) {
    log().debug("program cache: {} is damaged and will be replaced", path(key));
    return std::nullopt;
  }
  return ProgramBinary{header.format, {body.begin(), body.end()}};
}

void ProgramCache::store(const std::string& key, const ProgramBinary& binary) {
  if (!enabled()) return;
  Header header{};
  std::memcpy(header.magic, magic, sizeof(magic));
  std::memcpy(header.key, key.data(), std::min(key.size(), sizeof(header.key)));
  const std::string sum = checksum(binary.bytes);
  std::memcpy(header.checksum, sum.data(), sizeof(header.checksum));
  header.length = binary.bytes.size();
  header.format = binary.format;
  std::vector<std::byte> content(sizeof(header) + binary.bytes.size());
  std::memcpy(content.data(), &header, sizeof(header));
  std::copy(binary.bytes.begin(), binary.bytes.end(), content.begin() + sizeof(header));
  try {
    write_file_atomic(path(key), content);
  } catch (const Error& error) {
    log().warn("no program cache from here on: {}", error.what());
    dir_.clear();
  }
}

void ProgramCache::trim() const {
  struct Entry {
    fs::file_time_type time;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uint64_t total = 0;
  std::error_code error;
  for (fs::directory_iterator it(dir_, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != ".glprog") continue;
    std::error_code gone;  // another process may trim at the same time
    Entry entry{it->last_write_time(gone), it->file_size(gone), it->path()};
    if (gone) continue;
    total += entry.bytes;
    entries.push_back(std::move(entry));
  }
  if (total <= max_cache_bytes) return;
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.time < b.time; });
  for (const Entry& entry : entries) {
    if (total <= max_cache_bytes) break;
    if (fs::remove(entry.path, error)) total -= entry.bytes;
  }
}

}  // namespace loom::gpu
