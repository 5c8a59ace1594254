#pragma once
// Scenes made by hand and pipelines rendered of them, for tests with known answers.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "interop/camera.h"
#include "interop/light.h"
#include "loom/facts.h"
#include "scene/gpu_scene.h"
#include "scene/scene.h"
#include "support/gl.h"

namespace loom::test {

/// Flat-shaded geometry in world space, by materials.
class SceneBuilder {
 public:
  SceneBuilder();
  int material(glm::vec3 albedo, glm::vec3 emission = glm::vec3(0), bool double_sided = false);
  /// Counter-clockwise seen from the front.
  SceneBuilder& triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, int material);
  SceneBuilder& quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, int material);
  /// A square of side 2·half about `centre` that faces +y.
  SceneBuilder& floor(glm::vec3 centre, float half, int material);
  /// The six faces of a box, outwards.
  SceneBuilder& box(glm::vec3 low, glm::vec3 high, int material);
  SceneBuilder& point(glm::vec3 position, glm::vec3 intensity);
  SceneBuilder& spot(glm::vec3 position, glm::vec3 direction, glm::vec3 intensity, double inner_rad, double outer_rad);
  SceneBuilder& directional(glm::vec3 direction, glm::vec3 irradiance);
  SceneBuilder& sky(glm::vec3 radiance);
  /// All geometry added from here on moves by `path` in a second, in a straight line, and stops there.
  SceneBuilder& moving(glm::vec3 path);
  [[nodiscard]] scene::Scene build() const;

 private:
  scene::Scene scene_;
  std::optional<glm::vec3> path_;
};

/// Texels of a texture, (0,0) bottom left.
struct Texels {
  int width = 0, height = 0, layers = 1;
  std::vector<glm::vec4> values;
  [[nodiscard]] const glm::vec4& at(int x, int y, int layer = 0) const;
  [[nodiscard]] glm::vec4 mean() const;
  bool operator==(const Texels&) const = default;
};

struct BenchOptions {
  glm::ivec2 size{64, 64};
  std::vector<graph::Override> set;
  std::vector<std::string> requested;  ///< outputs to keep; empty = those that the pipeline names
  bool alias = true;
  bool prune = true;
  std::vector<std::string> disabled_rules;
  bool poison = false;
  std::uint32_t seed = 0;
  int frames = 1;
  glm::dvec2 jitter{0};  ///< shift of the samples, pixels
};

/// One scene, ready to be rendered with any pipeline. Owns the renderer of the last one.
class Bench {
 public:
  Bench(Device& device, scene::Scene scene);
  ~Bench();

  void look(const scene::Camera& camera) { camera_ = camera; }
  /// Straight at the point from the eye, `half_angle` radians up and down.
  void look(glm::dvec3 eye, glm::dvec3 target, double half_angle, glm::dvec3 up = {0, 1, 0});
  /// Straight down on y = 0 around the origin, orthographic: `half` metres to each side. +x right, −z up.
  void look_down(double half, double height = 10);

  /// `pipeline`: JSON, or the name of a file in pipelines/. Throws BadInput with all diagnostics.
  void render(const std::string& pipeline, const BenchOptions& options = {});
  /// Moves what the scene's animation moves to where it is at a time, from the next frame on.
  void pose(double time_s);
  /// One more frame of the last render's pipeline, from where the camera looks now.
  void next_frame(glm::dvec2 jitter = glm::dvec2(0));
  /// Changes a live parameter of the last render's pipeline.
  void set(const std::string& pass, const std::string& param, const std::string& value);
  /// Forgets history, as Session::reset() does; frames count from 0 again.
  void reset();
  /// Renders and reads one output ("image", "pass.port.member").
  Texels image(const std::string& pipeline, const std::string& output, BenchOptions options = {});
  /// An output of the last render; throws where it is absent.
  [[nodiscard]] Texels read(const std::string& output) const;
  [[nodiscard]] bool absent(const std::string& output) const;

  [[nodiscard]] const graph::Renderer& renderer() const { return *renderer_; }
  [[nodiscard]] const interop::Camera& camera() const { return block_; }
  [[nodiscard]] const SceneFacts& facts() const { return facts_; }
  /// As if `loom analyse` had found this.
  void measured(const SceneMeasurements& measurements) { facts_.measured = measurements; }
  [[nodiscard]] const SceneView& scene() const { return *gpu_; }
  /// World position of the surface that the pixel's centre sees at a distance.
  [[nodiscard]] glm::dvec3 position(int x, int y, double depth) const;

 private:
  Device& device_;
  scene::Scene scene_;
  SceneFacts facts_;
  scene::Camera camera_;
  interop::Camera block_{};
  std::unique_ptr<scene::GpuScene> gpu_;
  std::unique_ptr<graph::Renderer> renderer_;
  glm::ivec2 size_{0};
  std::uint64_t frame_ = 0;
  std::uint32_t seed_ = 0;
};

/// All passes of this build. Loaded once.
const Registry& all_passes();

/// The world ray through the centre of a texel of a light face (interop/light.h): origin and direction (unit for a
/// perspective face); `measure` is its solid angle by the centre form, or its area.
struct TexelRay {
  glm::dvec3 origin, direction;
  double measure;
};
TexelRay texel_ray(const interop::LightFace& face, int x, int y, int size);

}  // namespace loom::test
