#pragma once
// Run files: a scene with its camera, lights, sky, size, pipeline and parameters.
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "loom/diagnostic.h"
#include "loom/json.h"
#include "scene/scene.h"
#include "scene/sky.h"

namespace loom::scene {

/// A camera of the file by name, or one of one's own.
struct CameraChoice {
  std::variant<std::string, Camera> camera;
  SourceLocation where;
};

struct RunFile {
  std::string scene;     ///< empty: the built-in one
  std::string pipeline;  ///< empty where not given
  std::optional<CameraChoice> camera;
  std::optional<std::vector<Light>> lights;
  std::optional<SkyChoice> sky;
  SurfaceModel surfaces = SurfaceModel::lambert;
  std::optional<glm::ivec2> size;
  std::vector<std::pair<std::string, std::string>> set;
};

/// Reads a run file; every mistake in it becomes a diagnostic with its place. Throws BadInput with all of them.
RunFile read_run_file(const std::string& path);
/// `text`: a name or a JSON object, as `--camera` has it. Throws BadInput.
CameraChoice parse_camera(const std::string& text);

}  // namespace loom::scene
