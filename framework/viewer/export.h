#pragma once
// What a person takes away: a pipeline file, a run file, a command line. Text in, text out.
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "graph/compile/compile.h"
#include "scene/scene.h"
#include "viewer/live_pipeline.h"

namespace loom::viewer {

/// A pipeline that extends `base` (a path as it shall stand in the file) and says only what `set` changes.
std::string pipeline_text(const std::string& name, const std::string& base, const Settings& set);
/// --camera: JSON of a perspective view. `origin`: Scene::origin; text speaks in the file's own coordinates.
std::string camera_json(const scene::Camera& camera, const glm::dvec3& origin);
/// A run file with these lights instead of the scene's own, and a sky as scene::sky_json() has it.
std::string run_file_text(const std::string& scene, const std::vector<scene::Light>& lights, const std::string& sky,
                          const scene::Camera& camera, const glm::dvec3& origin);

struct RenderCommand {
  std::string scene, pipeline, camera;  ///< camera: a name or JSON; empty: the scene's own
  Settings set;
  glm::ivec2 size{512, 512};
  int frames = 1;
  double dt_s = 0;  ///< 0: nothing moves
  std::vector<std::string> plugin_dirs;
};
/// `loom render …`, quoted for a POSIX shell.
std::string command_text(const RenderCommand& command);

}  // namespace loom::viewer
