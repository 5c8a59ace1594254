// What surfaces are made of: textures, masks, vertex colours, normal maps, metal.
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "reference/scenes.h"
#include "support/hand_scene.h"

namespace loom::reference::test {
namespace {

constexpr double pi = std::numbers::pi;
using loom::test::quad;

/// Two by two texels: alpha, or the colour, `left` in the left column and `right` in the right one.
scene::Image columns(glm::u8vec4 left, glm::u8vec4 right) {
  scene::Image image{.width = 2, .height = 2};
  for (int row = 0; row < 2; ++row) {
    for (const glm::u8vec4& t : {left, right}) image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
  }
  return image;
}

scene::Material material(glm::vec3 albedo) {
  scene::Material m;
  m.base_color = glm::vec4(albedo, 1);
  return m;
}

/// A unit quad around the origin facing up, lit by a unit sky, with a material and an image.
SceneBuilder card(const scene::Material& m, scene::Image image = {}) {
  SceneBuilder b;
  b.scene.images.push_back(std::move(image));
  b.mesh(quad({-.5F, 0, .5F}, {1, 0, 0}, {0, 0, -1}), m);
  b.sky(glm::vec3(1));
  return b;
}

/// What is seen straight down on (x, 0, z), within a millimetre.
Film look_down(const scene::Scene& scene, double x, double z, Options options = {}) {
  return render(scene, probe({x, 1, z}, {x, 0, z}, 1e-3), {4, 4}, 16, options);
}

TEST(Surface, AlbedoIsBaseColourTimesNonMetal) {
  scene::Material m = material({.8F, .4F, .2F});
  m.metallic = .25F;
  const Film film = look_down(card(m).scene, 0, 0);
  expect_mean(over_pixels(film, Layer::albedo), glm::dvec3(.6, .3, .15), 1e-6);
  // A sky of radiance 1 over an open plane: E = π, L = ρ.
  expect_mean(over_pixels(film, Layer::radiance), glm::dvec3(.6, .3, .15));
}

TEST(Surface, TexturesAreDecodedThenFiltered) {
  scene::Material m = material(glm::vec3(1));
  m.base_color_texture.image = 0;
  const auto scene = card(m, columns({188, 188, 188, 255}, {0, 0, 0, 255})).scene;
  // sRGB 188 is linear .5029; texel centres lie at a quarter and three quarters.
  const double linear = std::pow((188 / 255. + .055) / 1.055, 2.4);
  expect_mean(over_pixels(look_down(scene, -.25, 0), Layer::albedo), glm::dvec3(linear), 3e-3);
  expect_mean(over_pixels(look_down(scene, 0, 0), Layer::albedo), glm::dvec3(linear / 2), 3e-3);
  expect_mean(over_pixels(look_down(scene, .125, 0), Layer::albedo), glm::dvec3(linear / 4), 6e-3);
}

TEST(Surface, TextureTransformAndSecondUvSet) {
  scene::Material m = material(glm::vec3(1));
  m.base_color_texture = {.image = 0, .uv_set = 1, .transform = glm::mat3x2(1, 0, 0, 1, .5F, 0), .nearest = true};
  scene::Primitive p = quad({-.5F, 0, .5F}, {1, 0, 0}, {0, 0, -1});
  p.uv1 = p.uv0;
  p.uv0.clear();
  SceneBuilder b;
  b.scene.images.push_back(columns({255, 255, 255, 255}, {0, 0, 0, 255}));
  b.mesh(p, m);
  b.sky(glm::vec3(1));
  EXPECT_EQ(over_pixels(look_down(b.scene, -.25, 0), Layer::albedo).mean.x, 0);  // u = .25 + .5: the right column
  EXPECT_EQ(over_pixels(look_down(b.scene, .25, 0), Layer::albedo).mean.x, 1);   // wraps to the left one
}

TEST(Surface, VertexColoursMultiply) {
  scene::Primitive p = quad({-.5F, 0, .5F}, {1, 0, 0}, {0, 0, -1});
  p.colors = {{1, .5F, 0, 1}, {1, .5F, 0, 1}, {0, .5F, 1, 1}, {0, .5F, 1, 1}};
  SceneBuilder b;
  b.mesh(p, material(glm::vec3(.5F)));
  expect_mean(over_pixels(look_down(b.scene, 0, 0), Layer::albedo), glm::dvec3(.25), 1e-3);
  expect_mean(over_pixels(look_down(b.scene, 0, .25), Layer::albedo), glm::dvec3(.375, .25, .125), 3e-3);
}

// MASK: below its cutoff the surface is not there, for the camera, for shadows and for bounces alike; at the cutoff it
// is. A blended surface is loaded as a mask of cutoff .5.
TEST(Surface, MaskCutsOutForEveryRay) {
  scene::Material m = material(glm::vec3(.5F));
  m.alpha = scene::AlphaMode::mask;
  m.base_color_texture = {.image = 0, .nearest = true};
  for (const auto& [cutoff, alpha, solid] :
       {std::tuple(.5F, 127, false), {.5F, 128, true}, {100 / 255.F, 100, true}, {100 / 255.F, 99, false}}) {
    SCOPED_TRACE(alpha);
    m.alpha_cutoff = cutoff;
    const auto a = static_cast<std::uint8_t>(alpha);
    SceneBuilder b = card(m, columns({255, 255, 255, a}, {255, 255, 255, 255}));
    b.scene.sky = glm::vec3(0);
    b.directional({0, -1, 0}, glm::vec3(1));
    b.quad({-2, -1, -2}, {0, 0, 4}, {4, 0, 0}, {.albedo = glm::vec3(.5F)});  // a floor below the card
    const double depth = over_pixels(look_down(b.scene, -.25, 0), Layer::normal).mean.y;
    EXPECT_EQ(depth, 1);
    const auto layers = look_down(b.scene, -.25, 0).layers();
    EXPECT_NEAR(layers.channels.at("depth.Z")[5], solid ? 1 : 2, 1e-5);
    // From below the card: the sun on the floor comes through the hole or does not.
    const Film floor = render(b.scene, probe({-.25, -.5, 0}, {-.25, -1, 0}, 1e-3), {4, 4}, 16);
    expect_mean(over_pixels(floor, Layer::direct), glm::dvec3(solid ? 0 : 1));
  }
}

TEST(Surface, VertexAlphaCountsForTheMask) {
  scene::Material m = material(glm::vec3(.5F));
  m.alpha = scene::AlphaMode::mask;
  scene::Primitive p = quad({-.5F, 0, .5F}, {1, 0, 0}, {0, 0, -1});
  p.colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};  // alpha = u
  SceneBuilder b;
  b.mesh(p, m);
  EXPECT_EQ(over_pixels(look_down(b.scene, -.1, 0), Layer::albedo).mean.x, 0);
  EXPECT_NEAR(over_pixels(look_down(b.scene, .1, 0), Layer::albedo).mean.x, .5, 1e-6);
}

// Emission has a texture and is cut out with its surface. Left column lit: E under the card's middle is half of the
// whole card's, .23946·π by symmetry.
TEST(Surface, EmissionIsTexturedAndCutOut) {
  for (const bool by_mask : {false, true}) {
    SCOPED_TRACE(by_mask);
    scene::Material m;
    m.base_color = glm::vec4(0, 0, 0, 1);
    m.emissive = glm::vec3(1);
    const scene::TextureRef ref{.image = 0, .nearest = true};
    if (by_mask) {
      m.alpha = scene::AlphaMode::mask;
      m.base_color_texture = ref;
    } else {
      m.emissive_texture = ref;
    }
    SceneBuilder b;
    const glm::u8vec4 white(255), off = by_mask ? glm::u8vec4(255, 255, 255, 0) : glm::u8vec4(0, 0, 0, 255);
    b.scene.images.push_back(columns(white, off));
    b.mesh(quad({-.5F, 1, -.5F}, {1, 0, 0}, {0, 0, 1}), m);
    b.quad({-5, 0, -5}, {0, 0, 10}, {10, 0, 0}, {.albedo = glm::vec3(.5F)});
    for (const Strategy s : {Strategy::mis, Strategy::light, Strategy::bsdf}) {
      const Film film = render(b.scene, probe({0, .5, 0}, {0, 0, 0}, 1e-3), {16, 16}, 256, {.strategy = s});
      expect_mean_within(over_pixels(film, Layer::emitter), glm::dvec3(.23946 * pi / 2), .05);
    }
  }
}

// A normal map tilts the shading normal by its own angle, towards +u and, on a mirrored instance, towards the mirrored
// +u: light from there at 45° is then seen at cos(45° − tilt).
TEST(Surface, NormalMapTiltsTheNormal) {
  const double tilt = .3;
  const auto encode = [](double v) { return static_cast<std::uint8_t>(std::lround((v + 1) / 2 * 255)); };
  for (const bool mirrored : {false, true}) {
    SCOPED_TRACE(mirrored);
    scene::Material m = material(glm::vec3(.5F));
    m.normal_texture.image = 0;
    scene::Primitive p = quad({-.5F, 0, .5F}, {1, 0, 0}, {0, 0, -1});
    p.tangents.assign(4, {1, 0, 0, 1});
    glm::dmat4 world(1);
    if (mirrored) world[0][0] = -1;
    const double side = mirrored ? -1 : 1;
    SceneBuilder b;
    const glm::u8vec4 texel(encode(std::sin(tilt)), encode(0), encode(std::cos(tilt)), 255);
    b.scene.images.push_back(columns(texel, texel));
    b.mesh(p, m, world);
    b.directional({-side, -1, 0}, glm::vec3(1));
    const Film film = look_down(b.scene, 0, 0);
    // 8-bit normals: half a step of 2/255 in each component.
    EXPECT_NEAR(over_pixels(film, Layer::normal).mean.x, side * std::sin(tilt), .005);
    expect_mean(over_pixels(film, Layer::direct), glm::dvec3(std::cos(pi / 4 - tilt)), .006);
    // The map's y runs along the bitangent, world −z here, on the mirrored instance too.
    const glm::u8vec4 up(encode(0), encode(std::sin(tilt)), encode(std::cos(tilt)), 255);
    b.scene.images[0] = columns(up, up);
    EXPECT_NEAR(over_pixels(look_down(b.scene, 0, 0), Layer::normal).mean.z, -std::sin(tilt), .005);
  }
}

// Both sides reflect; the normal is on the viewer's side.
TEST(Surface, BackFacesReflect) {
  SceneBuilder b;
  b.quad({-.5F, 0, -.5F}, {1, 0, 0}, {0, 0, 1}, {.albedo = glm::vec3(.5F)});  // its front looks down
  b.sky(glm::vec3(1));
  const Film film = look_down(b.scene, 0, 0);
  EXPECT_EQ(over_pixels(film, Layer::normal).mean, glm::dvec3(0, 1, 0));
  expect_mean(over_pixels(film, Layer::radiance), glm::dvec3(.5));
}

// Whatever is broken in the geometry, the image stays finite and what is whole is seen.
TEST(Surface, BrokenTrianglesDoNoHarm) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scene::Primitive broken;
  broken.positions = {{0, .5F, 0},   {0, .5F, 0},           {.1F, .5F, 0},
                      {nan, .5F, 0}, {1e30F, 1e30F, 1e30F}, {.1F, .5F, 1e-12F}};
  broken.normals.assign(6, glm::vec3(0));
  broken.indices = {0, 1, 2, 0, 2, 3, 0, 2, 4, 0, 2, 5};
  scene::Material lamp = material(glm::vec3(.5F));
  lamp.emissive = glm::vec3(1);
  SceneBuilder b = card(material(glm::vec3(.5F)));
  b.mesh(broken, lamp);
  const Film film = look_down(b.scene, .3, .3);  // render() expects that all samples are finite
  expect_mean(over_pixels(film, Layer::albedo), glm::dvec3(.5));
}

TEST(Surface, ZeroNormalFallsBackToTheTriangle) {
  scene::Primitive p = quad({-.5F, 0, .5F}, {1, 0, 0}, {0, 0, -1});
  p.normals.assign(4, glm::vec3(0));
  SceneBuilder b;
  b.mesh(p, material(glm::vec3(.5F)));
  EXPECT_EQ(over_pixels(look_down(b.scene, 0, 0), Layer::normal).mean, glm::dvec3(0, 1, 0));
}

}  // namespace
}  // namespace loom::reference::test
