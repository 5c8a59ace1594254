// Which scene, pipeline and program a point's figures come from.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "core/data_dir.h"
#include "gpu/hash.h"
#include "graph/compile/document.h"
#include "loom/diagnostic.h"
#include "measure/sweep/measure_point.h"

namespace loom::measure {
namespace {

namespace fs = std::filesystem;

void add_file(gpu::Hash128& hash, const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  hash.add(std::as_bytes(std::span(bytes)));
}

/// By size and time: reading every library for every point would cost more than some points do.
void add_stamp(gpu::Hash128& hash, const fs::path& path) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  const auto time = fs::last_write_time(path, error).time_since_epoch().count();
  hash.add(path.filename().string() + std::to_string(size) + ' ' + std::to_string(time));
}

template <class Add>
void add_folder(gpu::Hash128& hash, const fs::path& folder, const Add& add) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->is_regular_file(error)) files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) add(hash, file);
}

}  // namespace

std::string content_of(const Sweep& sweep, const Point& point, const std::string& truth_id,
                       const std::vector<std::string>& shader_roots) {
  gpu::Hash128 hash;
  hash.add(truth_id);
  Diagnostics ignored;
  for (const std::string& file : graph::load_file(sweep.pipelines[point.entry].path, ignored).files) {
    add_file(hash, file);
  }
  for (const std::string& root : shader_roots) add_folder(hash, root, add_file);
  const fs::path library = library_dir();
  for (const char* name : {"libloom.so", "loom/passes"}) {
    const fs::path path = library / name;
    if (fs::is_directory(path)) {
      add_folder(hash, path, add_stamp);
    } else {
      add_stamp(hash, path);
    }
  }
  return hash.hex();
}

}  // namespace loom::measure
