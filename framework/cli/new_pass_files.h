#pragma once
// What `loom new-pass` writes.
#include <map>
#include <string>

namespace loom::cli {

struct PassNames {
  std::string type;   ///< ScreenSpaceGather
  std::string snake;  ///< screen_space_gather
};

/// Text by path inside the folder.
std::map<std::string, std::string> new_pass_files(const PassNames& names);

}  // namespace loom::cli
