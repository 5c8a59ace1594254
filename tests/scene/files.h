#pragma once
#include <cstdlib>
#include <filesystem>

namespace loom::test {

/// $LOOM_SCENES, the folder of scenes that are not shipped; empty where it is unset or absent.
inline std::filesystem::path scenes_folder() {
  const char* folder = std::getenv("LOOM_SCENES");
  if (folder == nullptr || !std::filesystem::is_directory(folder)) return {};
  return folder;
}

}  // namespace loom::test
