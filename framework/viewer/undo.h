#pragma once
// What a person has changed, and the way back.
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "viewer/live_pipeline.h"

namespace loom::viewer {

/// Everything that undo restores. The camera is no edit: it has bookmarks, and a key that brings it home.
struct Edits {
  std::string pipeline;
  std::map<std::string, Settings> set;  ///< by pipeline: what differs from its file
  std::vector<scene::Light> lights;
};

class UndoStack {
 public:
  /// Before a change. Changes of one gesture (a slider that is dragged) become one step; an empty gesture never merges.
  void push(const Edits& before, const std::string& gesture) {
    redo_.clear();
    if (!gesture.empty() && gesture == gesture_ && !undo_.empty()) return;
    gesture_ = gesture;
    undo_.push_back(before);
    if (undo_.size() > capacity) undo_.erase(undo_.begin());
  }
  void end_gesture() { gesture_.clear(); }
  [[nodiscard]] bool can_undo() const { return !undo_.empty(); }
  [[nodiscard]] bool can_redo() const { return !redo_.empty(); }
  /// The state to go to; only where there is one.
  Edits undo(const Edits& now) { return move(undo_, redo_, now); }
  Edits redo(const Edits& now) { return move(redo_, undo_, now); }
  void clear() { undo_.clear(), redo_.clear(), end_gesture(); }

 private:
  static constexpr std::size_t capacity = 1000;
  Edits move(std::vector<Edits>& from, std::vector<Edits>& to, const Edits& now) {
    end_gesture();
    to.push_back(now);
    Edits target = from.back();
    from.pop_back();
    return target;
  }
  std::vector<Edits> undo_, redo_;
  std::string gesture_;
};

}  // namespace loom::viewer
