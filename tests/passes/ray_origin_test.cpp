// Rays from G-buffer points: the offset of trace.glsl is enough for a surface not to hide itself, and no more.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/camera.h"
#include "loom/gpu.h"
#include "loom/scene_view.h"
#include "scene/scene.h"
#include "support/bench.h"
#include "support/gl.h"
#include "support/hand_scene.h"
#include "support/run_compute.h"

namespace loom {
namespace {

const char* const shader = R"(
#include "lib/camera.glsl"
#include "lib/sampling.glsl"
#include "lib/trace.glsl"
layout(local_size_x = 64) in;
layout(std140) uniform camera_data { Camera camera; };
layout(std430) readonly buffer pixels_block { vec4 pixels[]; };  // xyz: geometric normal, w: depth
layout(std430) writeonly buffer counts_block { uvec4 counts[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= pixels.length()) return;
  ivec2 pixel = ivec2(i % uint(camera.size.x), i / uint(camera.size.x));
  vec3 n = normalize(pixels[i].xyz);
  float depth = pixels[i].w;
  vec3 p = surface_position(camera, pixel_uv(camera, pixel), depth);
  vec3 origin = offset_origin(p, n, depth);
  uvec4 count = uvec4(0);
  mat3 basis = orthonormal_basis(n);
  for (uint s = 0u; s < 16u; ++s) {
    // Down to a tenth of a degree above the surface.
    vec2 u = low_discrepancy(s, pixel_seed(uvec2(pixel), uvec4(0), 0u));
    float z = u.x * u.x + .0017;
    vec3 direction = normalize(basis * vec3(cos(6.2832 * u.y), sin(6.2832 * u.y), z));
    Hit hit = closest_hit(origin, direction, 1e30);
    if (!is_hit(hit)) { ++count.x; continue; }  // the room is closed
    // The room is convex: a ray that leaves a wall never meets the same wall.
    if (abs(dot(hit_normal(hit), n)) > .99 && hit.t < .5 * WALL_DISTANCE) ++count.y;
  }
  count.z = depth > 0. ? 1u : 0u;
  counts[i] = count;
}
)";

/// A closed box of 4 × 3 × 5 m around `centre`, turned so that no wall lies along an axis.
scene::Scene room(glm::dvec3 centre, double unit) {
  scene::Scene scene = test::empty_scene();
  const glm::dmat4 placed = glm::translate(glm::dmat4(1), centre * unit) *
                            glm::rotate(glm::dmat4(1), .7, glm::normalize(glm::dvec3(1, 2, .5))) *
                            glm::scale(glm::dmat4(1), glm::dvec3(2, 1.5, 2.5) * unit);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.F, 1.F}) {
      glm::vec3 a(0);
      glm::vec3 u(0);
      glm::vec3 v(0);
      a[axis] = side;
      u[(axis + 1) % 3] = 2;
      v[(axis + 2) % 3] = 2 * side;
      test::place(scene, test::quad(a - .5F * (u + v), u, v), placed);
    }
  }
  return scene;
}

class RayOrigin : public test::GlTest {};

TEST_F(RayOrigin, NoWallHidesItself) {
  struct Setup {
    glm::dvec3 centre;  // in units
    double unit;        // metres
  };
  write_shader("ray_origin_test.comp", shader);
  for (const Setup& setup :
       {Setup{{0, 0, 0}, 1}, Setup{{1000, -300, 20}, 1}, Setup{{3, 5, -2}, 1e-3}, Setup{{3, 5, -2}, 1e6}}) {
    SCOPED_TRACE(setup.unit);
    const auto device = make_device();
    test::Bench bench(*device, room(setup.centre, setup.unit));
    bench.look(setup.centre * setup.unit, (setup.centre + glm::dvec3(.3, -.2, 1)) * setup.unit, .9);
    test::BenchOptions options;
    for (const char* member : {"depth", "geometric_normal"})
      options.requested.push_back(std::string("gbuffer.surface.") + member);
    bench.render(R"({ "name": "surface", "passes": { "gbuffer": { "type": "GBuffer" } },
                      "outputs": { "image": "gbuffer.surface.albedo" } })",
                 options);
    const test::Texels depth = bench.read("gbuffer.surface.depth");
    std::vector<glm::vec4> pixels = bench.read("gbuffer.surface.geometric_normal").values;
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i].w = depth.values[i].r;

    SceneFacts facts = bench.facts();
    ProgramDesc desc{.files = {"ray_origin_test.comp"}, .defines = scene_defines(facts)};
    desc.defines.emplace_back("WALL_DISTANCE", std::to_string(3 * setup.unit));
    const auto program = device->program(desc);
    const Buffer camera(std::as_bytes(std::span(&bench.camera(), 1)), "camera");
    const Buffer in = Buffer::of(std::span<const glm::vec4>(pixels), "pixels");
    const Buffer out(pixels.size() * sizeof(glm::uvec4), "counts");
    test::run_compute(*program, bench.scene(),
                      {{"camera_data", &camera}, {"pixels_block", &in}, {"counts_block", &out}},
                      static_cast<unsigned int>((pixels.size() + 63) / 64));
    std::vector<glm::uvec4> counts(pixels.size());
    out.read(std::as_writable_bytes(std::span(counts)));
    glm::uvec4 sum(0);
    for (const glm::uvec4& count : counts) sum += count;
    EXPECT_EQ(sum.z, pixels.size()) << "every pixel sees a wall";
    EXPECT_EQ(sum.x, 0U) << "rays that left the closed room";
    EXPECT_EQ(sum.y, 0U) << "rays that met the wall they started on";
  }
}

}  // namespace
}  // namespace loom
