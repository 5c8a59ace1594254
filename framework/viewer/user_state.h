#pragma once
// What is kept from one run to the next, below the XDG directories: the window, and bookmarks by scene.
#include <map>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "scene/scene.h"

namespace loom::viewer {

struct Bookmark {
  std::string name;
  scene::Camera camera;
};

struct UserState {
  glm::ivec2 size{1440, 900};
  glm::ivec2 position{-1, -1};  ///< −1: where the window manager puts it
  float font_scale = 1;
  std::map<std::string, std::vector<Bookmark>> bookmarks;  ///< by scene path
};

/// loom::state_dir(), made where it is not there. Empty where it cannot be.
std::string made_state_dir();
/// A file that is missing or damaged is as good as none.
UserState load_user_state();
void save_user_state(const UserState& state);

}  // namespace loom::viewer
