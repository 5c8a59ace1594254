#pragma once
// The scene as a pass sees it while it executes: GPU geometry to draw, lights, camera, and versions that tell what
// changed.
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "loom/export.h"
#include "loom/facts.h"
#include "loom/gpu.h"

#include "interop/camera.h"
#include "interop/light.h"

namespace loom::scene {
struct Scene;
}

namespace loom {

/// The switches of shaders/lib that this scene requires: SCENE_TEXTURES, SCENE_NORMAL_MAPS, SCENE_ALPHA_MASK,
/// SCENE_SKY_IMAGE. Every
/// program that draws the scene, traces rays through it or reads the sky is compiled with them; a pass may clear facts
/// that its result does not depend on (normal maps for a shadow map).
LOOM_API std::vector<Define> scene_defines(const SceneFacts& facts);

/// Surfaces by alpha mode: without a mask, and with one.
enum class Surfaces { all, opaque, masked };
/// Surfaces by whether the scene's animation can move them.
enum class Motion { any, still, moving };

/// Scene buffers that shaders reach by these block names (shaders/lib/<block>.glsl):
/// scene_lights, scene_emitters, scene_bvh_nodes and scene_bvh_triangles (trace.glsl), scene_draws and scene_triangles
/// (material.glsl), scene_materials.
class LOOM_API SceneView {
 public:
  virtual ~SceneView() = default;
  [[nodiscard]] virtual const SceneFacts& facts() const = 0;
  [[nodiscard]] virtual std::span<const interop::Light> lights() const = 0;
  [[nodiscard]] virtual glm::vec3 sky_radiance() const = 0;  ///< W/(m² sr); of an image, the mean over the sphere
  /// Radians by which a sky that is an image is turned about +Y, from +Z towards +X.
  [[nodiscard]] virtual double sky_rotation() const { return 0; }
  /// ∫ L·Y dω of the sky's radiance up to a band (loom/harmonics.h), the rotation included.
  [[nodiscard]] virtual std::vector<glm::dvec3> sky_harmonics(int order) const;
  /// Change counters: equal numbers mean an equal state.
  [[nodiscard]] virtual std::uint64_t geometry_version() const = 0;
  /// Counts changes of what draw() shows as Motion::still: only a program that edits the scene makes any.
  [[nodiscard]] virtual std::uint64_t still_version() const { return geometry_version(); }
  [[nodiscard]] virtual std::uint64_t lights_version() const = 0;
  /// Draws all surfaces with the bound program (vertex stage: shaders/lib/scene_vertex.glsl), nothing culled, with
  /// each material's textures bound. `instances` repeats every triangle (gl_InstanceID), for layered targets. `which`:
  /// a shader that discards loses the early depth test, so that masked surfaces are better drawn by a program of their
  /// own, after the opaque ones.
  virtual void draw(const Program& program, int instances = 1, Surfaces which = Surfaces::all,
                    Motion motion = Motion::any) const = 0;
  /// The storage buffer of that block name, or null where the scene has none.
  [[nodiscard]] virtual const Buffer* buffer(std::string_view block) const = 0;
  /// Textures that shaders reach by sampler name (scene_alpha: r8 array of the alpha of masked materials;
  /// scene_sky: the sky's image, where it is one), or null.
  [[nodiscard]] virtual const Texture* texture(std::string_view sampler) const = 0;
  /// The scene on the CPU, posed as this view shows it, for a pass that traces rays itself; null where there is none.
  [[nodiscard]] virtual const scene::Scene* cpu_scene() const { return nullptr; }
};

}  // namespace loom
