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

/// `lightloom` in the folder that the variable names, else in one below HOME.
std::string user_dir(const char* variable, const char* below_home) {
  const auto set = [](const char* text) { return text != nullptr && *text != '\0'; };
  if (const char* named = std::getenv(variable); set(named)) return fs::path(named) / "lightloom";
  if (const char* home = std::getenv("HOME"); set(home)) return fs::path(home) / below_home / "lightloom";
  return {};
}

}  // namespace

std::string library_dir() {
  static const char anchor = 0;
  Dl_info info{};
  std::error_code failed;
  if (dladdr(&anchor, &info) == 0 || info.dli_fname == nullptr) return {};
  const fs::path path = fs::canonical(info.dli_fname, failed);
  return failed ? std::string() : path.parent_path().string();
}

std::string data_dir() {
  std::string tried;
  if (const char* named = std::getenv("LOOM_DATA_DIR"); named != nullptr && *named != '\0') {
    if (is_data_dir(named)) return named;
    throw Error("LOOM_DATA_DIR is " + std::string(named) +
                ", which has no configs/ and shaders/: unset it or name a data folder");
  }
  for (fs::path dir = library_dir(); !dir.empty(); dir = dir.parent_path()) {
    const fs::path candidate = dir / "share" / "loom";
    if (is_data_dir(candidate)) return fs::canonical(candidate).string();
    // lib/<triplet>/libloom.so is the deepest layout that an installation has.
    tried += (tried.empty() ? "" : ", ") + candidate.string();
    if (dir == dir.parent_path() || dir.filename() == "lib") {
      const fs::path above = dir.parent_path() / "share" / "loom";
      if (is_data_dir(above)) return fs::canonical(above).string();
      tried += ", " + above.string();
      break;
    }
  }
  throw Error("Lightloom's data folder was not found (tried " + tried +
              "): set LOOM_DATA_DIR to the folder that holds configs/ and shaders/");
}

std::string cache_dir() { return user_dir("XDG_CACHE_HOME", ".cache"); }

std::string state_dir() { return user_dir("XDG_STATE_HOME", ".local/state"); }

}  // namespace loom
