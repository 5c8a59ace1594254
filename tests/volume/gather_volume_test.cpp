// GatherVolume: a uniform field is πL, in one grid and across the borders of nested ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/camera.h"
#include "volume/field.h"

namespace loom::test {
namespace {

/// Coefficients of the intensity of a uniform field of radiance L in cells of size s: I = 3s²L/2 in every direction.
glm::vec4 uniform(double radiance, double s) {
  return {static_cast<float>(1.5 * s * s * radiance * 2 * std::sqrt(pi)), 0, 0, 0};
}

class GatherVolumeTest : public LpvTest {
 protected:
  /// A surface across z, 2·half wide about `centre`, seen straight on by every pixel.
  void add_plane(glm::vec3 centre, float half, glm::vec3 normal) {
    add_pass(registry_, "Plane", [=] {
      return PassFunctions{.reflect =
                               [](Ports& ports) {
                                 const glm::ivec2 size = ports.frame_size();
                                 ports.out("surface", "Surface")
                                     .texture("depth", TextureDesc::image(size, Format::r32f), Access::image_write)
                                     .texture("normal", TextureDesc::image(size, Format::rgba32f), Access::image_write);
                               },
                           .execute =
                               [=](Frame& f, const Bindings& io) {
                                 interop::Camera camera{};
                                 camera.eye = glm::vec4(centre - glm::vec3(0, 0, 1), 1);
                                 camera.forward = {0, 0, 1, 0};
                                 camera.right = {half, 0, 0, 0};
                                 camera.up = {0, half, 0, 0};
                                 camera.size = {f.size(), 1.F / glm::vec2(f.size())};
                                 io.publish("surface", camera);
                                 io.texture("surface.depth").clear(glm::vec4(1));
                                 io.texture("surface.normal").clear(glm::vec4(normal, 0));
                               }};
    });
  }
  graph::ReadImage gather(const std::string& parameters) {
    const auto renderer = make(R"({"passes": {
      "source": {"type": "Source"}, "plane": {"type": "Plane"},
      "bounce": {"type": "GatherVolume", "in": {"surface": "plane.surface", "volume": "source.flux"},
                 "params": {)" +
                               parameters + R"(}}}, "outputs": {"image": "bounce.irradiance"}})");
    frame(*renderer);
    return renderer->read("image");
  }
};

// Whatever the normal.
TEST_F(GatherVolumeTest, AUniformFieldIsPiTimesRadiance) {
  Field field(4);
  field.red.assign(field.red.size(), uniform(2.5, 1));
  add_source(field);
  add_plane({2, 2, 2}, .2F, {.6F, 0, .8F});
  for (const char* reconstruction : {"linear", "non-negative"}) {
    const auto image = gather(R"("reconstruction": ")" + std::string(reconstruction) + '"');
    for (const glm::vec4& e : image.texels) ASSERT_NEAR(e.r, 2.5 * pi, 1e-5 * 2.5 * pi) << reconstruction;
  }
}

// Σ L·(cosine lobe − c): with c a share of the lobe itself, that share of all light, whatever the field.
TEST_F(GatherVolumeTest, DirectionsThatANearFieldHasAnsweredAreLeftOut) {
  const glm::vec3 n{.6F, 0, .8F};
  Field field(4);
  field.red.assign(field.red.size(), {5, .7F, -.9F, 1.3F});
  add_source(field);
  add_plane({2, 2, 2}, .2F, n);
  float share = 0;
  add_pass(registry_, "Ended", [&] {
    return PassFunctions{.reflect =
                             [](Ports& ports) {
                               ports.out("ended", "Image")
                                   .texture("image", TextureDesc::layers(ports.frame_size(), 3, Format::rgba32f),
                                            Access::image_write);
                             },
                         .execute =
                             [&](Frame&, const Bindings& io) {
                               // unit_lobe() is the clamped cosine over π.
                               const auto s = share * static_cast<float>(pi);
                               io.texture("ended.image").clear(s * unit_lobe(n));
                             }};
  });
  const auto e = [&](const std::string& without) {
    const auto renderer = make(R"({"passes": {
      "source": {"type": "Source"}, "plane": {"type": "Plane"}, "ended": {"type": "Ended"},
      "bounce": {"type": "GatherVolume", "in": {"surface": "plane.surface", "volume": "source.flux")" +
                               without + R"(}}}, "outputs": {"image": "bounce.irradiance"}})");
    frame(*renderer);
    return renderer->read("image").texels[0].r;
  };
  const float all = e("");
  ASSERT_GT(all, 1);
  for (const float taken : {0.F, .25F, 1.F}) {
    share = taken;
    EXPECT_NEAR(e(R"(, "without": "ended.ended")"), (1 - taken) * all, 1e-5 * all) << taken;
  }
}

/// Three nested grids of 8³ cells of 1, 2 and 4 m about the point (8, 8, 8), each with a uniform field.
Field nested(double finest, double middle, double coarsest) {
  Field field(8, 3);
  const std::vector<double> radiance = {finest, middle, coarsest};
  for (int k = 0; k < 3; ++k) {
    const auto s = static_cast<float>(1 << k);
    field.grid.cascade[k] = glm::vec4(glm::vec3(8 - 4 * s), s);
    for (int i = 0; i < 512; ++i) {
      field.red[static_cast<std::size_t>(512 * k + i)] = uniform(radiance[static_cast<std::size_t>(k)], s);
    }
  }
  return field;
}

TEST_F(GatherVolumeTest, AUniformFieldIsPiTimesRadianceAcrossTheBordersOfCascades) {
  const Field field = nested(2.5, 2.5, 2.5);
  add_source(field);
  size_ = {64, 64};
  for (const float z : {-7.9F, 4.F, 4.6F, 8.F, 11.9F, 23.F}) {
    add_plane({8, 8, z}, 17, {0, .6F, .8F});  // reaches past the coarsest grid
    for (const char* blend : {"0", "1.5"}) {
      const auto image = gather(R"("blend": )" + std::string(blend));
      for (const glm::vec4& e : image.texels) ASSERT_NEAR(e.r, 2.5 * pi, 1e-5 * 2.5 * pi) << z << ' ' << blend;
    }
    registry_ = {};
    load_passes();
    add_source(field);
  }
}

// The finest that holds the point answers; over its border the next one takes over, without a jump and without a third
// one, whose slices lie next to it in the texture, mixing in.
TEST_F(GatherVolumeTest, TheFinestCascadeAnswersAndPassesOverIntoTheNext) {
  const Field field = nested(1, 10, 1000);
  add_source(field);
  size_ = {256, 1};
  // Facing +z, so that each cascade is read half a cell further on: on the axis of the finest, along x.
  add_plane({8, 8, 8}, 4.4F, {0, 0, 1});
  const auto image = gather(R"("blend": 1)");
  double before = 0;
  for (int i = 0; i < 256; ++i) {
    const double x = 8 + 4.4 * ((i + .5) / 128 - 1), inside = std::min(x - 4, 12 - x) - .5;
    const double share = std::clamp(inside, 0., 1.);
    const double e = image.texels[static_cast<std::size_t>(i)].r / pi;
    EXPECT_NEAR(e, share * 1 + (1 - share) * 10, 1e-3) << x;
    if (i > 0) {
      EXPECT_LT(std::abs(e - before), 9 * 8.8 / 256 + 1e-3);
    }
    before = e;
  }
}

// At the slices where one cascade ends and the next begins, filtering would read both: z at every height.
TEST_F(GatherVolumeTest, NothingIsInterpolatedBetweenTheSlabsOfTwoCascades) {
  const Field field = nested(1, 10, 1000);
  size_ = {1, 1};
  for (float z = 3.F; z < 13.F; z += .11F) {
    registry_ = {};
    load_passes();
    add_source(field);
    add_plane({8, 8, z}, .1F, {1, 0, 0});
    const double inside = std::min(z - 4., 12. - z) - .5;
    const double share = std::clamp(inside, 0., 1.);
    EXPECT_NEAR(gather(R"("blend": 1)").texels[0].r / pi, share + (1 - share) * 10, 1e-3) << z;
  }
}

}  // namespace
}  // namespace loom::test
