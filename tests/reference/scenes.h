#pragma once
// Small scenes with known answers, and how to render them.
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "reference/film.h"
#include "reference/path_tracer.h"
#include "scene/scene.h"

namespace loom::reference::test {

/// The same in every channel.
inline glm::vec3 grey(double value) { return glm::vec3(static_cast<float>(value)); }

/// Adds to a scene; every piece becomes a mesh, a material and an instance of its own.
class SceneBuilder {
 public:
  struct Look {
    glm::vec3 albedo{0};
    glm::vec3 emissive{0};
    bool double_sided = false;
  };

  /// As loom::test::quad.
  SceneBuilder& quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v, const Look& look);
  /// An axis-aligned box whose front faces inwards.
  SceneBuilder& room(glm::vec3 lower, glm::vec3 upper, const Look& look);
  /// A sphere of triangles, its corners at `radius`; 20·4^subdivisions triangles, fronts and smooth normals inwards.
  SceneBuilder& hollow_sphere(float radius, int subdivisions, const Look& look);
  SceneBuilder& mesh(scene::Primitive primitive, const scene::Material& material,
                     const glm::dmat4& world = glm::dmat4(1));
  SceneBuilder& point(glm::dvec3 position, glm::vec3 intensity);
  SceneBuilder& spot(glm::dvec3 position, glm::dvec3 direction, glm::vec3 intensity, double inner_deg,
                     double outer_deg);
  SceneBuilder& directional(glm::dvec3 direction, glm::vec3 irradiance);
  SceneBuilder& sky(glm::vec3 radiance);

  scene::Scene scene;
};

/// The Cornell box (Cornell University, measured data; metres/10), with its emissive quad or with a spot light.
scene::Scene cornell_box(bool with_quad = true);
scene::Camera cornell_camera();

/// A camera that sees `half` metres around `target` in every direction, orthographically.
scene::Camera probe(glm::dvec3 eye, glm::dvec3 target, double half);

Film render(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size, std::uint32_t samples,
            const Options& options = {});

/// A mean with its standard error, from the pixels' replicates or from independent runs.
struct Estimate {
  glm::dvec3 mean{0};
  glm::dvec3 error{0};
};
/// Of a quantity whose value all pixels share; the error from the spread of the pixels, which are independent.
Estimate over_pixels(const Film& film, Layer layer);

/// Half-width of the confidence interval in standard errors: with 4, a true value falls outside once in 16,000.
inline constexpr double confidence = 4;
/// Expects each channel of `estimate` within `confidence` standard errors of `expected`, give or take `rounding` (the
/// arithmetic's own, relative).
void expect_mean(const Estimate& estimate, glm::dvec3 expected, double rounding = 1e-5);
/// Also that the interval is narrow enough to say something: `confidence`·error ≤ `width`·expected.
void expect_mean_within(const Estimate& estimate, glm::dvec3 expected, double width);

}  // namespace loom::reference::test
