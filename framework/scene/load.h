#pragma once
// Scenes from glTF 2.0 (.gltf, .glb) and run files (.json).
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/facts.h"
#include "scene/scene.h"

namespace loom::scene {

struct LoadOptions {
  /// URIs of a glTF file may leave its folder: absolute paths, "..", symbolic links that point elsewhere. For scenes
  /// that one trusts, since a picture shows what was read.
  bool allow_outside = false;
};

/// Loads and poses a glTF file. Throws BadInput where the picture would be wrong; what is merely left out becomes a
/// warning in `diagnostics`. Nothing outside the file's folder is read unless that is allowed, and nothing is fetched
/// from a network.
LOOM_API Scene load_gltf(const std::string& path, Diagnostics& diagnostics, LoadOptions options = {});

/// What a run file or a bare scene path means, with every default filled in.
struct Setup {
  Scene scene;
  Camera camera;
  int camera_index = -1;  ///< into Scene::cameras where it is one of the file's: pose() may move that one
  std::optional<glm::ivec2> size;
  std::string pipeline;                                  ///< path, empty where not given
  std::vector<std::pair<std::string, std::string>> set;  ///< "pass.param", value as JSON text
};

/// `path`: .gltf, .glb, a run file, or empty for the built-in Cornell box. `camera`: empty, a name in the file, or a
/// JSON object as in a run file. Adds the headlamp where nothing at all emits, and says so (`headlamp`): a point light
/// at the camera, of π·d² W/sr, where d is the distance from the camera to the centre of the scene's box (at least a
/// quarter of its diagonal). A surface there that faces it gets E = π W/m², so its radiance is its albedo.
/// `surfaces`: instead of what the run file says.
LOOM_API Setup load_setup(const std::string& path, const std::string& camera, Diagnostics& diagnostics,
                          std::optional<SurfaceModel> surfaces = {}, LoadOptions options = {});
/// "lambert" or "ggx"; nothing for any other word.
LOOM_API std::optional<SurfaceModel> surface_model(std::string_view name);

/// Moves everything to where it is at `time_s` of the first animation (bind pose where there is none): node matrices,
/// lights, cameras, instances, skinned vertices. Returns false where nothing moved.
LOOM_API bool pose(Scene& scene, double time_s);

/// Far from the origin a float has few digits left for the scene itself (1e6 m: steps of 6 cm). Where that costs more
/// than three of its 24 bits, moves posed scene and lights so that they lie about the origin, in double, and remembers
/// by how much in Scene::origin. The step is a power of two, so that grids fall on the same cells.
LOOM_API void recentre(Scene& scene);

LOOM_API SceneFacts compute_facts(const Scene& scene);

}  // namespace loom::scene
