// Reflective shadow maps: what every texel stores, against the plane that it sees.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "../../passes/rsm/light_faces.h"
#include "support/bench.h"

namespace loom::test {
namespace {

const char* const pipeline = R"({ "passes": { "rsm": { "type": "RSM" } },
  "outputs": { "image": "rsm.lights.flux" } })";

constexpr double pi = 3.14159265358979323846;
constexpr glm::vec3 albedo{.8f, .5f, .2f};

double spot_edge(double cosine, double inner, double outer) {
  const double t = (cosine - std::cos(outer)) / std::max(.001, std::cos(inner) - std::cos(outer));
  return std::pow(std::clamp(t, 0., 1.), 2);
}

class Rsm : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::vector<graph::Override> sized(int size) const {
    return {{"rsm", "size", std::to_string(size)}, {"rsm", "shadow_size", "64"}};
  }
  glm::dvec3 total_flux(Bench& bench, int size) const {
    const Texels flux = bench.image(pipeline, "rsm.lights.flux", {.set = sized(size)});
    glm::dvec3 sum(0);
    for (const glm::vec4& texel : flux.values) sum += glm::dvec3(texel);
    return sum;
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

struct Seen {
  double distance = std::numeric_limits<double>::infinity();
  glm::dvec3 normal{0};
};

/// Checks depth, normal and Φ/A = ρE at every texel. `trace` is the scene in closed form; `irradiance` the light's
/// irradiance on a plane that faces it at distance r in direction ω.
void check_texels(Bench& bench, int size, const std::vector<graph::Override>& set,
                  const std::function<Seen(const TexelRay&)>& trace,
                  const std::function<double(double r, const glm::dvec3& direction)>& irradiance) {
  bench.render(pipeline, {.set = set, .requested = {"rsm.lights.flux", "rsm.lights.normal", "rsm.lights.depth"}});
  const Texels flux = bench.read("rsm.lights.flux"), normal = bench.read("rsm.lights.normal"),
               depth = bench.read("rsm.lights.depth");
  const auto faces = rsm::light_faces(bench.scene().lights(), bench.facts());
  ASSERT_EQ(static_cast<int>(faces.size()), flux.layers);
  int seen = 0, lit = 0;
  for (int layer = 0; layer < flux.layers; ++layer) {
    const auto& face = faces[static_cast<std::size_t>(layer)];
    const bool directional = static_cast<int>(face.forward.w) == LIGHT_DIRECTIONAL;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const TexelRay ray = texel_ray(face, x, y, size);
        const Seen truth = trace(ray);
        const double r = depth.at(x, y, layer).x;
        if (!std::isfinite(truth.distance)) {
          EXPECT_EQ(r, 0);
          EXPECT_EQ(flux.at(x, y, layer).x, 0);
          continue;
        }
        ++seen;
        ASSERT_NEAR(r, truth.distance, 2e-4 * truth.distance) << x << ' ' << y << ' ' << layer;
        const glm::dvec3 n(normal.at(x, y, layer));
        ASSERT_LT(glm::length(n - truth.normal), 1e-3);
        const double cosine = -glm::dot(truth.normal, ray.direction);
        const double area = (directional ? 1 : r * r) * ray.measure / cosine;
        const double e = irradiance(truth.distance, ray.direction) * cosine;
        if (e > 0) ++lit;
        // Φ and r are 32-bit floats; r² carries the rasteriser's interpolation twice. At a spot's outer edge a cosine
        // off by 6e-8 moves the falloff t² by 2t·6e-8/(cos_inner − cos_outer) < 6e-7 of the light's irradiance.
        for (int c = 0; c < 3; ++c) {
          ASSERT_NEAR(flux.at(x, y, layer)[c] / area, albedo[c] * e, 5e-4 * albedo[c] * e + 1e-6)
              << x << ' ' << y << ' ' << layer;
        }
      }
    }
  }
  EXPECT_GT(seen, size * size / 2);
  EXPECT_GT(lit, seen / 2);
}

Seen hit_floor(const TexelRay& ray, double half) {
  if (ray.direction.y >= 0) return {};
  const double t = -ray.origin.y / ray.direction.y;
  const glm::dvec3 p = ray.origin + t * ray.direction;
  if (std::abs(p.x) > half || std::abs(p.z) > half) return {};
  return {t, {0, 1, 0}};
}

/// From inside the box [−1,1]³.
Seen hit_room(const TexelRay& ray) {
  Seen nearest;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0) continue;
    const double side = ray.direction[axis] > 0 ? 1 : -1;
    const double t = (side - ray.origin[axis]) / ray.direction[axis];
    if (t >= nearest.distance) continue;
    nearest.distance = t;
    nearest.normal = glm::dvec3(0);
    nearest.normal[axis] = -side;
  }
  return nearest;
}

TEST_F(Rsm, SpotTexelsHoldAlbedoTimesIrradiance) {
  constexpr double inner = .3, outer = .8;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(.2, -1, .1));
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 20, scene.material(albedo)).spot({.3f, 2, .1f}, direction, glm::vec3(7), inner, outer);
  Bench bench(*device_, scene.build());
  check_texels(
      bench, 64, sized(64), [](const TexelRay& ray) { return hit_floor(ray, 20); },
      [&](double r, const glm::dvec3& w) { return 7 * spot_edge(glm::dot(w, direction), inner, outer) / (r * r); });
}

TEST_F(Rsm, PointTexelsHoldAlbedoTimesIrradianceOnSixFaces) {
  SceneBuilder scene;
  scene.box(glm::vec3(-1), glm::vec3(1), scene.material(albedo)).point({.3f, -.2f, .1f}, glm::vec3(5));
  Bench bench(*device_, scene.build());
  check_texels(bench, 32, sized(32), hit_room, [](double r, const glm::dvec3&) { return 5 / (r * r); });
}

TEST_F(Rsm, WideSpotTexelsHoldAlbedoTimesIrradianceOnSixFaces) {
  constexpr double inner = 1.2, outer = 1.4;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(.5, -1, .3));
  SceneBuilder scene;
  scene.box(glm::vec3(-1), glm::vec3(1), scene.material(albedo));
  scene.spot({.3f, -.2f, .1f}, direction, glm::vec3(5), inner, outer).point({0, 0, 0}, glm::vec3(0));
  Bench bench(*device_, scene.build());
  bench.render(pipeline, {.set = sized(32), .requested = {"rsm.lights.flux"}});
  const Texels flux = bench.read("rsm.lights.flux");
  ASSERT_EQ(flux.layers, 12);
  const auto faces = rsm::light_faces(bench.scene().lights(), bench.facts());
  for (int layer = 0; layer < 6; ++layer) {
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        const TexelRay ray = texel_ray(faces[static_cast<std::size_t>(layer)], x, y, 32);
        const double expected = .8 * 5 * spot_edge(glm::dot(ray.direction, direction), inner, outer) * ray.measure;
        ASSERT_NEAR(flux.at(x, y, layer).x, expected, 1e-4 * expected + 1e-8);
      }
    }
  }
}

TEST_F(Rsm, DirectionalTexelsHoldAlbedoTimesIrradiance) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 3, scene.material(albedo)).directional({.4f, -1, .3f}, glm::vec3(3));
  Bench bench(*device_, scene.build());
  check_texels(
      bench, 64, sized(64), [](const TexelRay& ray) { return hit_floor(ray, 3); },
      [](double, const glm::dvec3&) { return 3; });
}

TEST_F(Rsm, TotalFluxOfAPointLightIsAlbedoTimesPowerAtEveryResolution) {
  SceneBuilder scene;
  scene.box(glm::vec3(-1), glm::vec3(1), scene.material(albedo)).point({.3f, -.2f, .1f}, glm::vec3(5));
  Bench bench(*device_, scene.build());
  for (const int size : {64, 128, 256, 512}) {
    const glm::dvec3 sum = total_flux(bench, size);
    // The centre form sums to 4π within 1/N² (1.5e-5 at 256²).
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / (albedo[c] * 5 * 4 * pi), 1, 1.2 / (size * size)) << size;
  }
}

TEST_F(Rsm, TotalFluxOfASpotIsItsPowerAtEveryResolution) {
  constexpr double inner = .3, outer = .8;
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 50, scene.material(albedo)).spot({0, 2, 0}, {.2f, -1, .1f}, glm::vec3(7), inner, outer);
  Bench bench(*device_, scene.build());
  double power = 0;
  constexpr int steps = 100000;
  for (int i = 0; i < steps; ++i) {
    const double angle = outer * (i + .5) / steps;
    power += 7 * spot_edge(std::cos(angle), inner, outer) * 2 * pi * std::sin(angle) * outer / steps;
  }
  for (const int size : {64, 128, 256, 512, 1024}) {
    // A midpoint rule over an integrand with a kink at the inner cone: second order in the texel's width.
    EXPECT_NEAR(total_flux(bench, size).x / (albedo.x * power), 1, 10. / (size * size)) << size;
  }
}

TEST_F(Rsm, TotalFluxOfADirectionalLightIsWhatTheFloorReceives) {
  SceneBuilder scene;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(.4, -1, .3));
  scene.floor(glm::vec3(0), 3, scene.material(albedo)).directional(direction, glm::vec3(3));
  Bench bench(*device_, scene.build());
  const double power = 3 * 36 * -direction.y;
  for (const int size : {64, 128, 256, 512, 1024}) {
    // Texels are in or out by their centre: at most half a texel along each of the four borders of the floor.
    EXPECT_NEAR(total_flux(bench, size).x / (albedo.x * power), 1, 4. / size) << size;
  }
}

TEST_F(Rsm, NothingUnreadIsMadeAndNoLightIsAbsent) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 3, scene.material(albedo));
  Bench dark(*device_, scene.build());
  dark.render(pipeline, {.requested = {"rsm.lights.flux"}});
  EXPECT_TRUE(dark.absent("rsm.lights.flux"));
  scene.point({0, 1, 0}, glm::vec3(1));
  Bench bench(*device_, scene.build());
  bench.render(pipeline, {.set = sized(16), .requested = {"rsm.lights.shadow"}});
  for (const auto& resource : bench.renderer().graph().resources) EXPECT_NE(resource.name, "rsm.lights.flux");
  EXPECT_EQ(bench.read("rsm.lights.shadow").layers, 6);
}

TEST_F(Rsm, MoreThan32FacesAreDrawnInBatches) {
  SceneBuilder scene;
  scene.box(glm::vec3(-1), glm::vec3(1), scene.material(albedo));
  for (int i = 0; i < 7; ++i) scene.point({.1f * static_cast<float>(i) - .3f, 0, 0}, glm::vec3(1));
  Bench bench(*device_, scene.build());
  const Texels flux = bench.image(pipeline, "rsm.lights.flux", {.set = sized(32)});
  ASSERT_EQ(flux.layers, 42);
  double sum = 0;
  for (const glm::vec4& texel : flux.values) sum += texel.x;
  EXPECT_NEAR(sum / (7 * .8 * 4 * pi), 1, 1.2 / (32 * 32));
}

}  // namespace
}  // namespace loom::test
