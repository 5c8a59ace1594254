#include "viewer/file_watch.h"

#include <system_error>
#include <utility>

namespace loom::viewer {

bool FileWatch::look(const std::string& file, State& state) {
  std::error_code error;
  state.time = std::filesystem::last_write_time(file, error);
  if (error) return false;
  state.bytes = std::filesystem::file_size(file, error);
  return !error;
}

void FileWatch::watch(const std::vector<std::string>& files) {
  std::map<std::string, State> next;
  for (const std::string& file : files) {
    const auto known = files_.find(file);
    State state;
    if (known != files_.end()) {
      next.insert(*known);
    } else if (look(file, state)) {
      next.emplace(file, state);
    } else {
      next.emplace(file, State{});
    }
  }
  files_ = std::move(next);
}

std::vector<std::string> FileWatch::changed() {
  std::vector<std::string> names;
  for (auto& [file, known] : files_) {
    State now;
    if (!look(file, now) || now == known) continue;
    known = now;
    names.push_back(file);
  }
  return names;
}

}  // namespace loom::viewer
