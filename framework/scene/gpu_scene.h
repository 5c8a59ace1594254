#pragma once
// The scene on the GPU: one vertex and one index buffer, indirect draws by material, textures, lights, emitters, BVH.
#include <memory>

#include <glm/vec2.hpp>

#include "interop/camera.h"
#include "loom/export.h"
#include "loom/scene_view.h"
#include "scene/scene.h"
#include "scene/world.h"

namespace loom::scene {

class LOOM_API GpuScene : public SceneView {
 public:
  /// Uploads; needs a current context. The scene must outlive it. The BVH and the emitters are built when a pass first
  /// asks for them.
  static std::unique_ptr<GpuScene> create(const Scene& scene);
  /// After pose() or a change of lights: uploads what changed and raises the versions.
  virtual void update() = 0;
};

/// The camera block for an image of `size`, its samples shifted by `jitter` pixels (±.5; right and up). `box` is the
/// world box of the scene: it gives the near plane where the camera has none, and the far plane of an orthographic one.
LOOM_API interop::Camera make_camera(const Camera& camera, const Box& box, glm::ivec2 size,
                                     glm::dvec2 jitter = glm::dvec2(0));
/// The same with world_box(scene), which visits every vertex.
LOOM_API interop::Camera make_camera(const Camera& camera, const Scene& scene, glm::ivec2 size,
                                     glm::dvec2 jitter = glm::dvec2(0));

}  // namespace loom::scene
