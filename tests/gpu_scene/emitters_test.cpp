#include "scene/emitters.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"
#include "support/hand_scene.h"

namespace loom::scene {
namespace {

using test::add_material;
using test::empty_scene;
using test::place;
using test::quad;

Image image_of_texels(int width, int height, std::vector<std::uint8_t> rgba) {
  return {.name = "test", .width = width, .height = height, .rgba = std::move(rgba)};
}

TEST(Emitters, NoneWhereNothingEmits) {
  Scene scene = empty_scene();
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  EXPECT_TRUE(build_emitters(scene).empty());
}

TEST(Emitters, AreaRadianceAndShareOfPower) {
  Scene scene = empty_scene();
  const int bright = add_material(scene, {.emissive = {8, 8, 8}});
  const int dim = add_material(scene, {.emissive = {1, 2, 3}, .double_sided = true});
  // 1 m² × 8 against 6 m² × 2 × two sides.
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, bright));
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, dim), glm::scale(glm::dmat4(1), {3, 2, 1}));
  const auto emitters = build_emitters(scene);
  ASSERT_EQ(emitters.size(), 4U);
  EXPECT_FLOAT_EQ(emitters[0].a.w, .5F);
  EXPECT_FLOAT_EQ(emitters[2].a.w, 3);
  EXPECT_EQ(emitters[0].b.w, 0);
  EXPECT_EQ(emitters[2].b.w, 1);
  EXPECT_EQ(glm::vec3(emitters[3].radiance), glm::vec3(1, 2, 3));
  const double total = 8 + 24;
  EXPECT_NEAR(emitters[0].c.w, 4 / total, 1e-7);
  EXPECT_NEAR(emitters[1].c.w, 8 / total, 1e-7);
  EXPECT_NEAR(emitters[2].c.w, 20 / total, 1e-7);
  EXPECT_EQ(emitters[3].c.w, 1);
}

TEST(Emitters, FrontStaysInFrontUnderAMirror) {
  Scene scene = empty_scene();
  const int lamp = add_material(scene, {.emissive = {1, 1, 1}});
  // Front normal +z; mirrored in x, the front still faces +z.
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, lamp), glm::scale(glm::dmat4(1), {-1, 1, 1}));
  for (const interop::Emitter& e : build_emitters(scene)) {
    EXPECT_GT(glm::cross(glm::vec3(e.b - e.a), glm::vec3(e.c - e.a)).z, 0);
  }
}

TEST(Emitters, TextureIsAveragedOverTheTriangle) {
  Scene scene = empty_scene();
  // Left half black, right half white (sRGB 255 is 1), not filtered.
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 64; ++i) {
    const std::uint8_t value = i % 8 < 4 ? 0 : 255;
    texels.insert(texels.end(), {value, value, value, 255});
  }
  scene.images.push_back(image_of_texels(8, 8, texels));
  const int lamp = add_material(scene, {.emissive = {10, 20, 30}, .emissive_texture = {.image = 0, .nearest = true}});
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, lamp));
  const auto emitters = build_emitters(scene);
  ASSERT_EQ(emitters.size(), 2U);
  // The lower right triangle holds 3/4 of the white half's area.
  // 1/(2n) of the step of 10, n = 4·√2·8 rounded up.
  EXPECT_NEAR(emitters[0].radiance.r, 7.5, .11);
  EXPECT_NEAR(emitters[1].radiance.r, 2.5, .11);
  EXPECT_NEAR(emitters[0].radiance.b, 22.5, .33);
  EXPECT_NEAR(emitters[0].radiance.r + emitters[1].radiance.r, 10, 1e-4);
}

TEST(Emitters, MaskedPartsDoNotEmit) {
  Scene scene = empty_scene();
  scene.images.push_back(image_of_texels(2, 1, {255, 255, 255, 255, 255, 255, 255, 0}));
  const int lamp = add_material(
      scene, {.emissive = {4, 4, 4}, .alpha = AlphaMode::mask, .base_color_texture = {.image = 0, .nearest = true}});
  const int gone = add_material(scene, {.base_color = {1, 1, 1, .2F}, .emissive = {4, 4, 4}, .alpha = AlphaMode::mask});
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, lamp));
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, gone));
  const auto emitters = build_emitters(scene);
  ASSERT_EQ(emitters.size(), 2U);  // what is cut away wholly is no emitter
  // The mask's edge: 1/(2n) of the step of 4, n = 16.
  EXPECT_NEAR(emitters[0].radiance.r, 1, .125);
  EXPECT_NEAR(emitters[1].radiance.r, 3, .125);
  EXPECT_NEAR(emitters[0].radiance.r + emitters[1].radiance.r, 4, 1e-5);
}

}  // namespace
}  // namespace loom::scene
