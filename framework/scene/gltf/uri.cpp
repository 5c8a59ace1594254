#include "scene/gltf/uri.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace loom::scene::gltf {
namespace {

constexpr std::uint8_t not_a_digit = 255;

constexpr std::array<std::uint8_t, 256> base64_values() {
  std::array<std::uint8_t, 256> table{};
  table.fill(not_a_digit);
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < digits.size(); ++i) {
    table[static_cast<unsigned char>(digits[i])] = static_cast<std::uint8_t>(i);
  }
  return table;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> percent_decode(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = hex_value(text[i + 1]);
    const int low = hex_value(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    result += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return result;
}

/// Whether `path`, with all symbolic links followed, lies in `folder` or below it. What is not there does.
bool stays_within(const std::filesystem::path& folder, const std::filesystem::path& path) {
  std::error_code failed;
  const std::filesystem::path top = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, failed);
  if (failed) return false;
  const std::filesystem::path real = std::filesystem::weakly_canonical(path, failed);
  if (failed) return false;  // links in a circle
  return std::mismatch(top.begin(), top.end(), real.begin(), real.end()).first == top.end();
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  if (!uri.substr(0, comma).ends_with(";base64")) return std::nullopt;
  std::string_view text = uri.substr(comma + 1);
  while (text.ends_with('=')) text.remove_suffix(1);
  static constexpr std::array<std::uint8_t, 256> values = base64_values();
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const std::uint8_t value = values[static_cast<unsigned char>(c)];
    if (value == not_a_digit) return std::nullopt;
    bits = (bits << 6 | value) & 0xffffff;
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<std::byte>(bits >> held & 0xff));
    }
  }
  return bytes;
}

std::optional<std::string> resolve_uri(std::string_view uri, const std::string& folder, bool outside) {
  const std::optional<std::string> decoded = percent_decode(uri);
  if (!decoded || decoded->empty()) return std::nullopt;
  if (decoded->find('\0') != std::string::npos || decoded->find('\\') != std::string::npos) return std::nullopt;
  // A colon before the first slash is a scheme (or a drive).
  if (decoded->find(':') < decoded->find('/')) return std::nullopt;
  const std::filesystem::path named(*decoded), path = std::filesystem::path(folder) / named;
  if (outside) return path.string();
  if (named.is_absolute()) return std::nullopt;
  for (const std::filesystem::path& part : named) {
    if (part == "..") return std::nullopt;
  }
  if (!stays_within(folder, path)) return std::nullopt;
  return path.string();
}

std::optional<std::vector<std::byte>> read_file(const std::string& path, std::size_t max_bytes, std::string& why) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) {
    why = std::filesystem::exists(path, failed) ? "is no regular file" : "does not exist";
    return std::nullopt;
  }
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (size < 0) {
    why = "cannot be read";
    return std::nullopt;
  }
  if (static_cast<std::uint64_t>(size) > max_bytes) {
    why = "has " + std::to_string(size) + " bytes, over the limit of " + std::to_string(max_bytes);
    return std::nullopt;
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), size);
  if (!file) {
    why = "cannot be read";
    return std::nullopt;
  }
  return bytes;
}

}  // namespace loom::scene::gltf
