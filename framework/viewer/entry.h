#pragma once
// The inspector as `loom view` calls it. The library is loaded when it is asked for, so that headless runs load no
// window system.
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "graph/compile/compile.h"
#include "scene/scene.h"

namespace loom::viewer {

struct Options {
  std::string scene;                                 ///< path; empty: the built-in one
  std::string pipeline;                              ///< path; empty: the run file's, else `lpv`
  std::string camera;                                ///< as --camera
  std::optional<scene::SurfaceModel> surfaces = {};  ///< none: as the scene says
  std::vector<graph::Override> set;
  std::optional<glm::ivec2> size;  ///< of the frame; none: the view's size
  std::vector<std::string> plugin_dirs;
  bool allow_outside = false;  ///< as --allow-outside: also for scenes that are opened later
};

/// Symbol of the library: runs until the window is closed. Throws Error.
using Run = void (*)(const Options& options);
inline constexpr const char* run_symbol = "loom_viewer_run";
inline constexpr const char* library_name = "libloom_viewer.so";

}  // namespace loom::viewer
