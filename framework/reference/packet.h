#pragma once
// Sixteen rays that are traced together.
#include <limits>

#include <glm/vec3.hpp>

#include "reference/embree_scene.h"

namespace loom::reference {

/// Rays of sixteen lanes; those that are not valid are left out.
class Packet {
 public:
  void put(int lane, const glm::vec3& origin, const glm::vec3& direction) {
    RTCRay16& ray = rays_.ray;
    ray.org_x[lane] = origin.x;
    ray.org_y[lane] = origin.y;
    ray.org_z[lane] = origin.z;
    ray.dir_x[lane] = direction.x;
    ray.dir_y[lane] = direction.y;
    ray.dir_z[lane] = direction.z;
    ray.tnear[lane] = 0;
    ray.tfar[lane] = std::numeric_limits<float>::infinity();
    ray.time[lane] = 0;
    ray.mask[lane] = ~0U;
    ray.flags[lane] = 0;
    rays_.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    rays_.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  void trace(const EmbreeScene& scene, const int* valid, bool coherent) { scene.intersect(valid, rays_, coherent); }
  [[nodiscard]] bool hit(int lane) const { return rays_.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; }
  [[nodiscard]] float distance(int lane) const { return rays_.ray.tfar[lane]; }
  [[nodiscard]] TrianglePoint point(int lane) const {
    return {.geometry = rays_.hit.geomID[lane],
            .triangle = rays_.hit.primID[lane],
            .uv = {rays_.hit.u[lane], rays_.hit.v[lane]}};
  }

 private:
  alignas(64) RTCRayHit16 rays_{};
};

/// Rays of sixteen lanes that ask whether something is in the way.
class ShadowPacket {
 public:
  /// `distance`: metres, may be infinite.
  void put(int lane, const glm::vec3& origin, const glm::vec3& direction, float distance) {
    ray_.org_x[lane] = origin.x;
    ray_.org_y[lane] = origin.y;
    ray_.org_z[lane] = origin.z;
    ray_.dir_x[lane] = direction.x;
    ray_.dir_y[lane] = direction.y;
    ray_.dir_z[lane] = direction.z;
    ray_.tnear[lane] = 0;
    ray_.tfar[lane] = distance;
    ray_.time[lane] = 0;
    ray_.mask[lane] = ~0U;
    ray_.flags[lane] = 0;
  }
  void trace(const EmbreeScene& scene, const int* valid) { scene.occluded(valid, ray_); }
  [[nodiscard]] bool blocked(int lane) const { return ray_.tfar[lane] < 0; }

 private:
  alignas(64) RTCRay16 ray_{};
};

}  // namespace loom::reference
