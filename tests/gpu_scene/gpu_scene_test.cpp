// What GpuScene hands to passes: versions, buffers, layered draws.
#include "scene/gpu_scene.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/light.h"
#include "interop/scene.h"
#include "loom/gpu.h"
#include "loom/scene_view.h"
#include "scene/scene.h"
#include "support/gl.h"
#include "support/hand_scene.h"

namespace loom::scene {
namespace {

using test::add_material;
using test::empty_scene;
using test::place;
using test::quad;

class GpuSceneTest : public test::GlTest {
 protected:
  template <class T>
  static std::vector<T> content(const Buffer& buffer) {
    std::vector<T> items(buffer.bytes() / sizeof(T));
    buffer.read(std::as_writable_bytes(std::span(items)));
    return items;
  }
};

TEST_F(GpuSceneTest, BuffersThatTheSceneLacksAreNull) {
  const Scene scene = empty_scene();
  const auto gpu = GpuScene::create(scene);
  for (const char* block : {"scene_lights", "scene_emitters", "scene_bvh_nodes", "scene_draws", "no_such_block"}) {
    EXPECT_EQ(gpu->buffer(block), nullptr) << block;
  }
  EXPECT_NE(gpu->buffer("scene_materials"), nullptr);
  EXPECT_EQ(gpu->texture("scene_alpha"), nullptr);
  gpu->update();
}

TEST_F(GpuSceneTest, VersionsRiseWithWhatChanges) {
  Scene scene = empty_scene();
  const int lamp = add_material(scene, {.emissive = {1, 1, 1}});
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, lamp));
  scene.lights.push_back({});
  const auto gpu = GpuScene::create(scene);
  const auto geometry = gpu->geometry_version();
  const auto lights = gpu->lights_version();
  const auto corner = [&] { return content<interop::Emitter>(*gpu->buffer("scene_emitters"))[0].a; };
  EXPECT_EQ(corner().x, 0);
  gpu->update();
  EXPECT_EQ(gpu->geometry_version(), geometry);
  EXPECT_EQ(gpu->lights_version(), lights);

  scene.instances[0].world = glm::translate(glm::dmat4(1), {7, 0, 0});
  gpu->update();
  EXPECT_GT(gpu->geometry_version(), geometry);
  EXPECT_EQ(gpu->lights_version(), lights);
  EXPECT_EQ(corner().x, 7) << "emitters follow";
  EXPECT_EQ(content<interop::Draw>(*gpu->buffer("scene_draws"))[0].world[3].x, 7);
  EXPECT_EQ(content<interop::BvhNode>(*gpu->buffer("scene_bvh_nodes"))[0].lower.x, 7);

  const auto moved = gpu->geometry_version();
  scene.lights[0].intensity = {2, 2, 2};
  gpu->update();
  EXPECT_EQ(gpu->geometry_version(), moved);
  EXPECT_GT(gpu->lights_version(), lights);
  EXPECT_EQ(content<interop::Light>(*gpu->buffer("scene_lights"))[0].intensity.r, 2);
  const auto lit = gpu->lights_version();
  scene.sky = {1, 1, 1};
  gpu->update();
  EXPECT_GT(gpu->lights_version(), lit);
}

TEST_F(GpuSceneTest, SkinnedVerticesAreUploadedAgain) {
  Scene scene = empty_scene();
  Primitive skinned = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  skinned.joints.assign(4, {});
  skinned.weights.assign(4, {1, 0, 0, 0});
  place(scene, quad({5, 5, 5}, {1, 0, 0}, {0, 1, 0}));
  place(scene, skinned);
  const auto gpu = GpuScene::create(scene);
  const auto before = gpu->geometry_version();
  scene.meshes[1].primitives[0].positions = {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}};
  gpu->update();
  EXPECT_GT(gpu->geometry_version(), before);
  const auto normals = content<glm::vec4>(*gpu->buffer("scene_triangles"));
  ASSERT_EQ(normals.size(), 4U);
  EXPECT_EQ(glm::vec3(normals[0]), glm::vec3(0, 0, 1));
  EXPECT_EQ(glm::vec3(normals[2]), glm::vec3(-1, 0, 0));
}

TEST_F(GpuSceneTest, LightsTakeOneFaceOrSix) {
  Scene scene = empty_scene();
  scene.lights = {{.kind = LightKind::spot, .outer_rad = 1},
                  {.kind = LightKind::point},
                  {.kind = LightKind::spot, .outer_rad = 1.3},
                  {.kind = LightKind::directional, .intensity = {3, 4, 5}}};
  const auto gpu = GpuScene::create(scene);
  const std::vector<float> first{0, 1, 7, 13};
  const std::vector<float> faces{1, 6, 6, 1};
  ASSERT_EQ(gpu->lights().size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(gpu->lights()[i].direction.w, first[i]);
    EXPECT_EQ(gpu->lights()[i].intensity.w, faces[i]);
  }
  EXPECT_EQ(gpu->facts().light_faces(), 14);
  EXPECT_EQ(gpu->lights()[3].position.w, LIGHT_DIRECTIONAL);
  EXPECT_FLOAT_EQ(gpu->lights()[0].cone.x, .54030231F);
}

TEST_F(GpuSceneTest, CopiesOfADrawKeepItsNumber) {
  // Three quads in a row, each of its own colour, drawn to four rows by gl_InstanceID.
  Scene scene = empty_scene();
  for (int i = 0; i < 3; ++i) {
    const int colour = add_material(scene, {.base_color = {.25F * static_cast<float>(i + 1), 0, 0, 1}});
    place(scene, quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, colour), glm::translate(glm::dmat4(1), {i, 0, 0}));
  }
  write_shader("copies.vert", R"(
#include "lib/scene_vertex.glsl"
flat out int copy;
void main() {
  vec3 p = scene_vertex();
  copy = gl_InstanceID;
  gl_Position = vec4(2. * (p.x / 3.) - 1., 2. * ((p.y + float(gl_InstanceID)) / 4.) - 1., .5, 1);
})");
  write_shader("copies.frag", R"(
#include "lib/material.glsl"
flat in int copy;
layout(location = 0) out vec4 color;
void main() { color = vec4(surface_albedo().r, float(copy), float(gl_PrimitiveID), surface_geometric_normal().z); }
)");
  const auto gpu = GpuScene::create(scene);
  const auto device = make_device();
  const auto program = device->program({.files = {"copies.vert", "copies.frag"}});
  const Texture target(TextureDesc::image({12, 16}, Format::rgba32f), "target");
  GLuint framebuffer = 0;
  glCreateFramebuffers(1, &framebuffer);
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, target.name(), 0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, 12, 16);
  target.clear(glm::vec4(0));
  for (const auto& block : program->interface().storage_blocks) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(block.location_or_binding),
                     gpu->buffer(block.name)->name());
  }
  gpu->draw(*program, 4);
  const std::vector<glm::vec4> texels = target.read();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &framebuffer);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column) {
      // Below the diagonal the first triangle, above it the second.
      const glm::vec4 low = texels[static_cast<std::size_t>((4 * row) * 12 + 4 * column + 2)];
      const glm::vec4 high = texels[static_cast<std::size_t>((4 * row + 2) * 12 + 4 * column)];
      const float colour = .25F * static_cast<float>(column + 1);
      EXPECT_EQ(low, glm::vec4(colour, row, 0, 1)) << row << " " << column;
      EXPECT_EQ(high, glm::vec4(colour, row, 1, 1)) << row << " " << column;
    }
  }
}

}  // namespace
}  // namespace loom::scene
