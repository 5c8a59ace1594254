#include "support/user_cache.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "support/temp_dir.h"

namespace loom::test {
namespace {

std::string text_of(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? "" : text;
}

/// Sets the environment once; the folder goes with the process.
struct OwnCache {
  OwnCache() {
    std::string before = text_of("XDG_CACHE_HOME");
    const std::string home = text_of("HOME");
    if (before.empty() && !home.empty()) before = std::filesystem::path(home) / ".cache";
    if (!before.empty()) {
      std::error_code ignored;
      std::filesystem::create_directories(before, ignored);  // Mesa makes its own folder there, but not what is above
      setenv("MESA_SHADER_CACHE_DIR", before.c_str(), 0);
    }
    setenv("XDG_CACHE_HOME", dir.path().c_str(), 1);
  }
  TempDir dir;
};

}  // namespace

void isolate_user_cache() { static const OwnCache own; }

}  // namespace loom::test
