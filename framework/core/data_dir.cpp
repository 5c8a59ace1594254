#include "core/data_dir.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "loom/diagnostic.h"

namespace loom {
namespace {

namespace fs = std::filesystem;

bool is_data_dir(const fs::path& dir) {
  std::error_code ignored;
  return fs::is_directory(dir / "configs", ignored) && fs::is_directory(dir / "shaders", ignored);
}

fs::path own_library() {
  static const char anchor = 0;
  Dl_info info{};
  if (dladdr(&anchor, &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code failed;
  fs::path path = fs::canonical(info.dli_fname, failed);
  return failed ? fs::path() : path;
}

}  // namespace

std::string data_dir() {
  std::string tried;
  if (const char* named = std::getenv("LOOM_DATA_DIR"); named != nullptr && *named != '\0') {
    if (is_data_dir(named)) return named;
    throw Error("LOOM_DATA_DIR is " + std::string(named) +
                ", which has no configs/ and shaders/: unset it or name a data folder");
  }
  const fs::path library = own_library();
  for (fs::path dir = library.parent_path(); !dir.empty(); dir = dir.parent_path()) {
    const fs::path candidate = dir / "share" / "loom";
    if (is_data_dir(candidate)) return candidate.string();
    // lib/<triplet>/libloom.so is the deepest layout that an installation has.
    tried += (tried.empty() ? "" : ", ") + candidate.string();
    if (dir == dir.parent_path() || dir.filename() == "lib") {
      const fs::path above = dir.parent_path() / "share" / "loom";
      if (is_data_dir(above)) return above.string();
      tried += ", " + above.string();
      break;
    }
  }
#ifdef LOOM_SOURCE_DIR
  // A library that still lies in its build tree uses the sources; an installed one must not.
  const fs::path relative = library.lexically_relative(LOOM_BINARY_DIR);
  if (!relative.empty() && *relative.begin() != "..") return LOOM_SOURCE_DIR;
#endif
  throw Error("Lightloom's data folder was not found (tried " + tried +
              "): set LOOM_DATA_DIR to the folder that holds configs/ and shaders/");
}

}  // namespace loom
