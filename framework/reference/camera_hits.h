#pragma once
// The visible surface of sixteen samples of a pixel, where every kind of path begins.
#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "interop/camera.h"
#include "reference/embree_scene.h"
#include "reference/film.h"
#include "reference/lights.h"
#include "reference/packet.h"
#include "reference/sampler.h"

namespace loom::reference {

static_assert(lanes == replicates);

/// The ray through `inside` (0 … 1 each way, v down) of a pixel: its unit direction, and where it starts.
glm::vec3 camera_ray(const interop::Camera& camera, glm::ivec2 pixel, glm::vec2 inside, glm::vec3& eye);

/// Samples [first, first + count) of a pixel, one of each replicate. A Path has `sampler`, `direction` and `at`, the
/// surface that is seen. Lanes that see one are alive (−1), the others not (0); a sample begins with what it shows
/// without light: the sky, or the surface and what it emits. The first pair of the sampler places it in the pixel.
template <class Path>
void find_visible(const EmbreeScene& geometry, const Lights& lights, std::uint64_t seed, const interop::Camera& camera,
                  glm::ivec2 pixel, std::uint32_t first, int count, Packet& packet, std::array<Path, lanes>& paths,
                  std::array<Sample, lanes>& samples, std::array<int, lanes>& alive) {
  const auto number = static_cast<std::uint64_t>(pixel.y) * static_cast<std::uint64_t>(camera.size.x) +
                      static_cast<std::uint64_t>(pixel.x);
  alive.fill(0);
  for (int i = 0; i < count; ++i) {
    const std::uint32_t s = first + static_cast<std::uint32_t>(i);
    Path& path = paths[static_cast<std::size_t>(i)];
    path = {};
    path.sampler = PathSampler(seed, number, s % replicates, s / replicates);
    glm::vec3 eye(0);
    path.direction = camera_ray(camera, pixel, path.sampler.pair(0), eye);
    packet.put(i, eye, path.direction);
    samples[static_cast<std::size_t>(i)] = {};
    alive[static_cast<std::size_t>(i)] = -1;
  }
  packet.trace(geometry, alive.data(), true);
  for (int i = 0; i < count; ++i) {
    Path& path = paths[static_cast<std::size_t>(i)];
    Sample& s = samples[static_cast<std::size_t>(i)];
    if (!packet.hit(i)) {
      s.radiance = lights.sky(path.direction);
      alive[static_cast<std::size_t>(i)] = 0;
      continue;
    }
    path.at = geometry.surface(packet.point(i), path.direction);
    s.hit = true;
    s.depth = packet.distance(i);
    s.albedo = path.at.albedo;
    s.normal = path.at.normal;
    s.radiance = path.at.emission;
  }
}

}  // namespace loom::reference
