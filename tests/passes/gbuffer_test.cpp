// The G-buffer against planes, colours and cut-outs that are known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gpu/device.h"
#include "graph/run/renderer.h"
#include "scene/scene.h"
#include "support/bench.h"
#include "support/gl.h"
#include "support/hand_scene.h"

namespace loom {
namespace {

using scene::AlphaMode;
using scene::Camera;
using scene::Material;
using scene::Scene;
using test::add_material;
using test::empty_scene;
using test::place;
using test::quad;
using test::Texels;

const char* const pipeline = R"({
  "name": "surface",
  "passes": { "gbuffer": { "type": "GBuffer" } },
  "outputs": { "image": "gbuffer.surface.albedo" }
})";

/// A unit in the last place of a half float below 1: OpenGL leaves it to the driver whether to round or to cut off.
constexpr double half_ulp = 1. / 2048;
constexpr double unit_vector_error = 1.7320508 * half_ulp;

struct Surface {
  std::map<std::string, Texels> members;
  std::unique_ptr<test::Bench> bench;

  [[nodiscard]] const glm::vec4& at(const std::string& member, int x, int y) const {
    return members.at(member).at(x, y);
  }
  [[nodiscard]] double depth(int x, int y) const { return static_cast<double>(at("depth", x, y).r); }
  [[nodiscard]] glm::dvec3 vector(const std::string& member, int x, int y) const {
    return glm::dvec3(at(member, x, y));
  }
};

class GBuffer : public test::GlTest {
 protected:
  Surface render(Scene scene, const Camera& camera, const std::vector<std::string>& members,
                 test::BenchOptions options = {}) {
    device_ = make_device();
    Surface surface;
    surface.bench = std::make_unique<test::Bench>(*device_, std::move(scene));
    surface.bench->look(camera);
    for (const std::string& member : members) options.requested.push_back("gbuffer.surface." + member);
    surface.bench->render(pipeline, options);
    for (const std::string& member : members) {
      const std::string output = "gbuffer.surface." + member;
      if (!surface.bench->absent(output)) surface.members[member] = surface.bench->read(output);
    }
    return surface;
  }

 private:
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// From (0, 0, 5) towards −z; orthographic: 4 m wide and high.
Camera front_camera(bool orthographic = true) {
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.target = {0, 0, 0};
  camera.orthographic = orthographic;
  camera.ymag = camera.xmag = 2;
  return camera;
}

Material textured(int image, Material material = {}) {
  material.base_color_texture = {.image = image, .nearest = true};
  return material;
}

/// Largest error of the depth against the ray's distance to the plane, over the pixels that see it, in roundings of it
/// (2⁻²⁴).
double depth_error(const Surface& surface, glm::dvec3 on_plane, glm::dvec3 normal, int& seen) {
  double worst = 0;
  const Texels& depth = surface.members.at("depth");
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const double d = surface.depth(x, y);
      if (d == 0) continue;
      ++seen;
      const glm::dvec3 origin = surface.bench->position(x, y, 0);
      const glm::dvec3 ray = surface.bench->position(x, y, 1) - origin;
      const double truth = glm::dot(on_plane - origin, normal) / glm::dot(ray, normal);
      worst = std::max(worst, std::abs(d / truth - 1) * (1 << 24));
    }
  }
  return worst;
}

struct Plane {
  const char* name;
  glm::vec3 a, u, v;
  double roundings;  ///< that transform, interpolation and ray come to
};

class GBufferPlanes : public GBuffer, public ::testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(Projections, GBufferPlanes, ::testing::Bool(),
                         [](const auto& projection) { return projection.param ? "Orthographic" : "Perspective"; });

TEST_P(GBufferPlanes, DepthIsTheDistanceAlongTheRay) {
  // The floor passes below the eye: interpolation is in 1/w, which is some ten times larger where the polygon comes
  // near than where it goes out of sight, and rounds in proportion to the larger.
  std::vector<Plane> planes{{"facing", {-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, 8},
                            {"tilted", {-3, -2, 1}, {6, 1, -2}, {-.5F, 4, 2}, 8}};
  if (!GetParam()) planes.push_back({"floor from behind the eye", {-50, -4, 50}, {100, 0, 0}, {0, 6, -100}, 32});
  for (const Plane& plane : planes) {
    for (const glm::dvec2 jitter : {glm::dvec2(0), glm::dvec2(.4, -.3)}) {
      SCOPED_TRACE(plane.name);
      Scene scene = empty_scene();
      place(scene, quad(plane.a, plane.u, plane.v));
      const Surface surface = render(std::move(scene), front_camera(GetParam()),
                                     {"depth", "normal", "geometric_normal"}, {.size = {128, 128}, .jitter = jitter});
      const glm::dvec3 front = glm::normalize(glm::cross(glm::dvec3(plane.u), glm::dvec3(plane.v)));
      int seen = 0;
      const double worst = depth_error(surface, plane.a, front, seen);
      EXPECT_GT(seen, 128 * 32);
      EXPECT_LT(worst, plane.roundings);
      for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
          if (surface.depth(x, y) == 0) continue;
          ASSERT_LT(glm::distance(surface.vector("normal", x, y), front), unit_vector_error);
          ASSERT_LT(glm::distance(surface.vector("geometric_normal", x, y), front), unit_vector_error);
        }
      }
    }
  }
}

TEST_F(GBuffer, BackgroundIsZeroAndTheNearestWins) {
  Scene scene = empty_scene();
  const int near = add_material(scene, {.base_color = {.25F, .5F, .75F, 1}});
  place(scene, quad({-1, -1, 1}, {1, 0, 0}, {0, 2, 0}, near));
  place(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  place(scene, quad({-1, -1, 8}, {2, 0, 0}, {0, 2, 0}));  // behind the viewer
  const Surface surface = render(std::move(scene), front_camera(), {"depth", "normal", "albedo"});
  EXPECT_EQ(surface.at("depth", 2, 2), glm::vec4(0, 0, 0, 1));
  EXPECT_EQ(surface.at("albedo", 2, 2), glm::vec4(0));
  EXPECT_EQ(surface.at("normal", 2, 2), glm::vec4(0));
  EXPECT_NEAR(surface.depth(24, 32), 4, 1e-6);
  EXPECT_NEAR(surface.depth(40, 32), 5, 1e-6);
  EXPECT_EQ(surface.at("albedo", 24, 32), glm::vec4(.25F, .5F, .75F, 1));
  EXPECT_EQ(surface.at("albedo", 40, 32), glm::vec4(1));
}

TEST_F(GBuffer, EmptySceneIsBackground) {
  const Surface surface = render(empty_scene(), front_camera(), {"depth", "normal", "albedo"});
  EXPECT_EQ(surface.members.at("depth").mean(), glm::vec4(0, 0, 0, 1));
  EXPECT_EQ(glm::vec3(surface.members.at("albedo").mean()), glm::vec3(0));
}

TEST_F(GBuffer, AlbedoIsFactorTimesTextureTimesColourTimesOneMinusMetallic) {
  Scene scene = empty_scene();
  // sRGB 188 is .5029 linear; the right half is black.
  scene.images.push_back({.name = "base", .width = 2, .height = 1, .rgba = {255, 188, 0, 255, 0, 0, 0, 255}});
  // Linear: blue 51 is .2 metallic; sRGB would be .033.
  scene.images.push_back({.name = "metal", .width = 1, .height = 1, .rgba = {255, 255, 51, 255}});
  Material material = textured(0, {.base_color = {.5F, 1, 1, 1}, .metallic = .5F});
  material.metallic_roughness_texture = {.image = 1};
  scene::Primitive board = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, add_material(scene, material));
  board.colors = {{1, .5F, 1, 1}, {1, .5F, 1, 1}, {.5F, .5F, 1, 1}, {.5F, .5F, 1, 1}};  // red halves with height
  place(scene, board);
  const Surface surface = render(std::move(scene), front_camera(), {"albedo"});
  const double diffuse = 1 - .5 * .2;
  const glm::dvec4 left = surface.at("albedo", 24, 32);
  const double height = .5 + .5 / 32;  // of the pixel's centre on the board
  EXPECT_NEAR(left.r, .5 * (1 - .5 * height) * diffuse, half_ulp);
  EXPECT_NEAR(left.g, .5029 * .5 * diffuse, half_ulp);
  EXPECT_EQ(left.b, 0);
  EXPECT_EQ(left.a, 1);
  EXPECT_EQ(surface.at("albedo", 40, 32), glm::vec4(0, 0, 0, 1));
}

TEST_F(GBuffer, TextureRowZeroIsAtVZeroAndTransformsApply) {
  Scene scene = empty_scene();
  scene.images.push_back({.name = "quarters",
                          .width = 2,
                          .height = 2,
                          .rgba = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}});
  place(scene, quad({-2, -1, 0}, {2, 0, 0}, {0, 2, 0}, add_material(scene, textured(0))));
  Material shifted = textured(0);
  shifted.base_color_texture.uv_set = 1;
  shifted.base_color_texture.transform = {1, 0, 0, 1, .5F, 0};
  scene::Primitive right = quad({0, -1, 0}, {2, 0, 0}, {0, 2, 0}, add_material(scene, shifted));
  right.uv1 = right.uv0;
  right.uv0.assign(4, {.75F, .75F});
  place(scene, right);
  const Surface surface = render(std::move(scene), front_camera(), {"albedo"});
  const glm::vec4 red(1, 0, 0, 1);
  const glm::vec4 green(0, 1, 0, 1);
  const glm::vec4 blue(0, 0, 1, 1);
  const glm::vec4 white(1);
  // v grows with y here, and row 0 lies at v = 0.
  EXPECT_EQ(surface.at("albedo", 8, 24), red);
  EXPECT_EQ(surface.at("albedo", 24, 24), green);
  EXPECT_EQ(surface.at("albedo", 8, 40), blue);
  EXPECT_EQ(surface.at("albedo", 24, 40), white);
  EXPECT_EQ(surface.at("albedo", 40, 24), green);
  EXPECT_EQ(surface.at("albedo", 56, 24), red);
  EXPECT_EQ(surface.at("albedo", 40, 40), white);
}

TEST_F(GBuffer, MaskCutsByTextureFactorAndVertexAlpha) {
  Scene scene = empty_scene();
  scene.images.push_back({.name = "halves", .width = 2, .height = 1, .rgba = {255, 255, 255, 255, 255, 255, 255, 60}});
  const int masked = add_material(scene, textured(0, {.alpha = AlphaMode::mask}));
  const int low = add_material(scene, textured(0, {.alpha_cutoff = .2F, .alpha = AlphaMode::mask}));
  const int factor = add_material(scene, {.base_color = {1, 1, 1, .4F}, .alpha = AlphaMode::mask});
  const int opaque = add_material(scene, textured(0, {.base_color = {1, 1, 1, .1F}}));
  place(scene, quad({-2, -2, 0}, {2, 0, 0}, {0, 2, 0}, masked));
  place(scene, quad({0, -2, 0}, {2, 0, 0}, {0, 2, 0}, low));
  place(scene, quad({-2, 0, 0}, {1, 0, 0}, {0, 2, 0}, factor));
  place(scene, quad({-1, 0, 0}, {1, 0, 0}, {0, 2, 0}, opaque));
  scene::Primitive fading = quad({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, masked);
  fading.uv0.assign(4, {.25F, .5F});
  fading.colors = {{1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 0}};
  place(scene, fading);
  const Surface surface = render(std::move(scene), front_camera(), {"depth"});
  const auto seen = [&](int x, int y) { return surface.depth(x, y) > 0; };
  EXPECT_TRUE(seen(8, 16));
  EXPECT_FALSE(seen(24, 16));
  EXPECT_TRUE(seen(40, 16));
  EXPECT_TRUE(seen(56, 16)) << "60/255 is above the cutoff of .2";
  EXPECT_FALSE(seen(8, 48));
  EXPECT_TRUE(seen(24, 48)) << "opaque materials ignore alpha";
  EXPECT_TRUE(seen(48, 46));
  EXPECT_FALSE(seen(48, 50));
}

// Interpolation rounds a constant: without the bound in Material::least_alpha() a slanted surface has holes.
TEST_F(GBuffer, AlphaThatEqualsTheCutoffIsThereEverywhere) {
  Scene one = empty_scene();
  place(one, quad({-9, -9, 1}, {18, 0, 0}, {0, 18, -5},
                  add_material(one, {.base_color = {1, 1, 1, .5F}, .alpha_cutoff = .5F, .alpha = AlphaMode::mask})));
  const Surface slanted = render(std::move(one), front_camera(false), {"depth"});
  for (int y = 16; y < 48; ++y)
    for (int x = 0; x < 64; ++x) ASSERT_GT(slanted.depth(x, y), 0) << x << ' ' << y;
}

TEST_F(GBuffer, NormalsFaceTheViewerOnBothSides) {
  Scene scene = empty_scene();
  place(scene, quad({-2, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  place(scene, quad({0, -1, 0}, {0, 2, 0}, {2, 0, 0}));  // its front faces −z
  const Surface surface = render(std::move(scene), front_camera(), {"normal", "geometric_normal"});
  for (const int x : {16, 48}) {
    EXPECT_EQ(glm::vec3(surface.at("normal", x, 32)), glm::vec3(0, 0, 1)) << x;
    EXPECT_EQ(glm::vec3(surface.at("geometric_normal", x, 32)), glm::vec3(0, 0, 1)) << x;
  }
}

TEST_F(GBuffer, BackOfSingleSidedFaceDoesNotEmit) {
  // One emitter single-sided, one double-sided; each seen from its front, its back, and mirrored.
  const glm::vec3 bright(1e6F, 2, .001F);
  Scene scene = empty_scene();
  const int single = add_material(scene, {.emissive = bright});
  const int both = add_material(scene, {.emissive = bright, .double_sided = true});
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1), std::acos(-1.), {0, 1, 0});
  const glm::dmat4 mirrored = glm::scale(glm::dmat4(1), {-1, 1, 1});
  const std::vector<glm::dmat4> poses{glm::dmat4(1), turned, mirrored, turned * mirrored};
  for (std::size_t i = 0; i < 4; ++i) {
    const double y = -2 + static_cast<double>(i);
    for (const int material : {single, both}) {
      const glm::dvec3 centre(material == single ? -1 : 1, y + .5, 0);
      place(scene, quad({-1, -.5F, 0}, {2, 0, 0}, {0, 1, 0}, material),
            glm::translate(glm::dmat4(1), centre) * poses[i]);
    }
  }
  const Surface surface = render(std::move(scene), front_camera(), {"emission", "normal"});
  const std::vector<bool> front{true, false, true, false};
  for (int i = 0; i < 4; ++i) {
    const int y = 8 + 16 * i;
    EXPECT_EQ(glm::vec3(surface.at("emission", 16, y)), front[static_cast<std::size_t>(i)] ? bright : glm::vec3(0))
        << i;
    EXPECT_EQ(glm::vec3(surface.at("emission", 48, y)), bright) << i;
    EXPECT_EQ(glm::vec3(surface.at("normal", 16, y)), glm::vec3(0, 0, 1)) << i;
  }
}

TEST_F(GBuffer, NormalsFollowTransformsThatStretchAndMirror) {
  // A slope of normal (1, 1, 1)/√3, stretched by (−2, 1, 3): the inverse transpose gives (−1/2, 1, 1/3).
  Scene scene = empty_scene();
  const glm::vec3 n(1, 1, 1);
  const glm::vec3 u = glm::normalize(glm::cross(glm::vec3(0, 1, 0), n));
  const glm::vec3 v = glm::normalize(glm::cross(n, u));
  place(scene, quad(-u - v, 2.F * u, 2.F * v), glm::scale(glm::dmat4(1), {-2, 1, 3}));
  const Surface surface = render(std::move(scene), front_camera(), {"normal", "geometric_normal"});
  const glm::dvec3 expected = glm::normalize(glm::dvec3(-.5, 1, 1. / 3));
  EXPECT_LT(glm::distance(surface.vector("normal", 32, 32), expected), unit_vector_error);
  EXPECT_LT(glm::distance(surface.vector("geometric_normal", 32, 32), expected), unit_vector_error);
}

TEST_F(GBuffer, ShadingNormalIsInterpolatedTheGeometricOneIsNot) {
  Scene scene = empty_scene();
  scene::Primitive board = quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  board.normals = {{-.6F, 0, .8F}, {.6F, 0, .8F}, {.6F, 0, .8F}, {-.6F, 0, .8F}};
  place(scene, board);
  const Surface surface = render(std::move(scene), front_camera(), {"normal", "geometric_normal"});
  for (const int x : {0, 20, 40, 63}) {
    const double s = (x + .5) / 64;
    const glm::dvec3 expected = glm::normalize(glm::dvec3(-.6 + 1.2 * s, 0, .8));
    EXPECT_LT(glm::distance(surface.vector("normal", x, 10), expected), unit_vector_error);
    EXPECT_EQ(glm::vec3(surface.at("geometric_normal", x, 10)), glm::vec3(0, 0, 1));
  }
}

TEST_F(GBuffer, NormalMapsBendTheNormalInTangentSpace) {
  Scene scene = empty_scene();
  // (218, 128, 218): x = .7098, y = .0039, z = .7098.
  scene.images.push_back({.name = "bent", .width = 1, .height = 1, .rgba = {218, 128, 218, 255}});
  Material material{.normal_scale = .5F};
  material.normal_texture = {.image = 0};
  const int bent = add_material(scene, material);
  const auto board = [&](float y, float w) {
    scene::Primitive primitive = quad({-1, y, 0}, {2, 0, 0}, {0, 1, 0}, bent);
    primitive.tangents.assign(4, {0, 1, 0, w});  // tangent up: bitangent n × t = −x for w = 1
    return primitive;
  };
  place(scene, board(-2, 1));
  place(scene, board(-1, -1));
  place(scene, board(0, 1), glm::scale(glm::dmat4(1), {-1, 1, 1}));
  place(scene, board(1, 1),
        glm::translate(glm::dmat4(1), {0, 3, 0}) * glm::rotate(glm::dmat4(1), std::acos(-1.), {1, 0, 0}));
  const Surface surface = render(std::move(scene), front_camera(), {"normal", "geometric_normal"});
  const double x = .5 * (2 * 218. / 255 - 1);
  const double y = .5 * (2 * 128. / 255 - 1);
  const double z = 2 * 218. / 255 - 1;
  const auto expect = [&](int row, glm::dvec3 n) {
    EXPECT_LT(glm::distance(surface.vector("normal", 32, row), glm::normalize(n)), unit_vector_error) << row;
    EXPECT_EQ(glm::vec3(surface.at("geometric_normal", 32, row)), glm::vec3(0, 0, 1)) << row;
  };
  expect(8, {-y, x, z});
  expect(24, {y, x, z});
  expect(40, {y, x, z});  // the mirror moves the bitangent along
  // Turned about x, seen from behind: the bent normal is turned, then flipped to the viewer.
  expect(56, {y, x, z});
}

TEST_F(GBuffer, OnlyWhatIsReadIsMade) {
  Scene scene = empty_scene();
  place(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  const Surface surface = render(std::move(scene), front_camera(), {"albedo"});
  EXPECT_EQ(surface.bench->renderer().graph().bytes, 64U * 64 * (2 + 4)) << "albedo, grey, and hardware depth";
}

TEST_F(GBuffer, LeavingOutWhatTheSceneLacksChangesNoBit) {
  const auto scene = [] {
    Scene made = empty_scene();
    place(made, quad({-1, -1, 0}, {2, 0, .3F}, {0, 2, 0}, add_material(made, {.base_color = {.1F, .7F, .3F, 1}})));
    return made;
  };
  const std::vector<std::string> members{"depth", "normal", "geometric_normal", "albedo"};
  const Surface pruned = render(scene(), front_camera(false), members);
  const Surface all = render(scene(), front_camera(false), members, {.prune = false});
  for (const std::string& member : members) EXPECT_EQ(pruned.members.at(member), all.members.at(member)) << member;
  const Surface emission = render(scene(), front_camera(false), {"emission"}, {.prune = false});
  EXPECT_EQ(emission.members.at("emission").at(32, 32), glm::vec4(0, 0, 0, 1));
}

TEST_F(GBuffer, KeepsItsOutputsWhileNothingChanges) {
  Scene scene = empty_scene();
  place(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  const Surface surface = render(std::move(scene), front_camera(), {"depth"}, {.frames = 2});
  EXPECT_EQ(surface.bench->renderer().kept_passes(), std::vector<std::string>{"gbuffer"});
  EXPECT_NEAR(surface.depth(32, 32), 5, 1e-6);
}

}  // namespace
}  // namespace loom
