#include "loom/cache.h"

#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "core/data_dir.h"
#include "core/image_io.h"
#include "core/log.h"

namespace loom {
namespace {

std::filesystem::path path_of(std::string_view name) {
  const std::string dir = cache_dir();
  return dir.empty() ? std::filesystem::path() : std::filesystem::path(dir) / name;
}

}  // namespace

std::optional<std::vector<std::byte>> read_cached(std::string_view name, std::size_t bytes) {
  const std::filesystem::path path = path_of(name);
  std::error_code failed;
  if (path.empty() || std::filesystem::file_size(path, failed) != bytes || failed) return std::nullopt;
  std::vector<std::byte> content(bytes);
  std::ifstream file(path, std::ios::binary);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what streams take
  file.read(reinterpret_cast<char*>(content.data()), static_cast<std::streamsize>(bytes));
  if (!file) return std::nullopt;
  return content;
}

void write_cached(std::string_view name, std::span<const std::byte> bytes) {
  const std::filesystem::path path = path_of(name);
  if (path.empty()) return;
  std::error_code failed;
  std::filesystem::create_directories(path.parent_path(), failed);
  try {
    write_file_atomic(path.string(), bytes);
  } catch (const std::exception& error) {
    log().warn("{} is not kept: {}", path.string(), error.what());
  }
}

}  // namespace loom
