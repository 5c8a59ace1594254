#pragma once
// Which of some files were saved since the last look.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace loom::viewer {

class FileWatch {
 public:
  /// Files that were watched already keep their state, so that no change between two calls is lost.
  void watch(const std::vector<std::string>& files);
  /// Those whose time or size changed, or that came back. A file that is gone for a moment (editors save by renaming)
  /// is not reported until it is there again.
  std::vector<std::string> changed();

 private:
  struct State {
    std::filesystem::file_time_type time;
    std::uintmax_t bytes = 0;
    bool operator==(const State&) const = default;
  };
  static bool look(const std::string& file, State& state);
  std::map<std::string, State> files_;
};

}  // namespace loom::viewer
