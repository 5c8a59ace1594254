#pragma once
// The scene as Embree sees it: every instance flattened to world-space triangles, recentred in double before the
// positions become float, and masked materials tested inside the traversal.
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include <embree3/rtcore.h>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"

namespace loom::reference {

/// Rays are traced in packets of this many: one path of each replicate of a pixel.
inline constexpr int lanes = 16;

/// One primitive of one instance.
struct Geometry {
  const scene::Scene* scene = nullptr;
  const scene::Primitive* primitive = nullptr;
  const scene::Material* material = nullptr;
  const glm::vec3* positions = nullptr;  ///< recentred world positions, owned by Embree
  glm::mat3 normal_matrix{1};            ///< inverse transpose of the instance's linear part
  glm::mat3 linear{1};
  float orientation = 1;   ///< −1 where the instance mirrors: the front is where the corners run clockwise
  bool glossy = false;     ///< under scene::SurfaceModel::ggx, and more than diffuse
  bool textured = false;   ///< textures or vertex colours: shading needs UVs
  int first_emitter = -1;  ///< Lights: the emitter of triangle i is first_emitter + i; −1 = does not emit
};

/// A point of the scene's surface with all that shading needs. Normals are on the side it is seen from.
struct SurfacePoint {
  glm::vec3 position{0};          ///< recentred, metres
  glm::vec3 geometric_normal{0};  ///< unit
  glm::vec3 normal{0};            ///< unit, shading
  glm::vec3 albedo{0};            ///< ρ = baseColor·(1−metallic)·(1−transmission)
  glm::vec3 emission{0};          ///< exitant radiance towards the viewer, W/(m² sr)
  float offset = 0;               ///< metres; how far off the surface rays start
  int emitter = -1;
  // What follows is of a surface that is more than diffuse (scene::SurfaceModel::ggx), `glossy`; docs/specular.md.
  bool glossy = false;
  bool inside = false;      ///< seen from behind: where it is glass, from within
  float alpha = 1;          ///< of GGX: roughness²
  float transmission = 0;   ///< share that is glass
  float ior = 1.5F;         ///< index of refraction
  glm::vec3 f0{0};          ///< reflectance along the normal
  glm::vec3 base_color{1};  ///< what glass lets through

  /// Where rays that leave the surface start.
  [[nodiscard]] glm::vec3 start() const { return position + geometric_normal * offset; }
  /// The same for a ray along `direction`, which may go through the surface.
  [[nodiscard]] glm::vec3 start(const glm::vec3& direction) const {
    return position + geometric_normal * (glm::dot(geometric_normal, direction) < 0 ? -offset : offset);
  }
};

/// Where on which triangle: Embree's barycentrics, (1−u−v)·a + u·b + v·c.
struct TrianglePoint {
  std::uint32_t geometry = 0, triangle = 0;
  glm::vec2 uv{0};
};

class EmbreeScene {
 public:
  /// Keeps pointers into `scene`. `origin` (world, metres) becomes the origin of all positions and rays.
  EmbreeScene(const scene::Scene& scene, const glm::dvec3& origin);
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() = default;

  /// `valid`: −1 for the lanes to trace, 0 for the others.
  void intersect(const int* valid, RTCRayHit16& rays, bool coherent) const;
  /// tfar becomes −∞ where something is in the way.
  void occluded(const int* valid, RTCRay16& rays) const;

  /// `direction`: unit, the way the ray went that found the point.
  [[nodiscard]] SurfacePoint surface(const TrianglePoint& at, const glm::vec3& direction) const;
  /// Radiance emitted on the front of the triangle at that point; 0 where the material is cut out.
  [[nodiscard]] glm::vec3 emission(const TrianglePoint& at) const;
  [[nodiscard]] glm::vec3 position(const TrianglePoint& at) const;
  /// The three corners.
  void corners(const TrianglePoint& at, glm::vec3& a, glm::vec3& b, glm::vec3& c) const;
  /// How far off a triangle a ray must start, so that rounding does not let it hit the triangle.
  [[nodiscard]] static float offset(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

  [[nodiscard]] const std::vector<Geometry>& geometries() const { return geometries_; }
  /// Whether some surface is more than diffuse.
  [[nodiscard]] bool any_glossy() const;
  [[nodiscard]] std::vector<Geometry>& geometries() { return geometries_; }

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  void add(const scene::Scene& scene, const scene::Instance& instance, const scene::Primitive& primitive,
           const glm::dvec3& origin);

  std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene> embree_;
  std::vector<Geometry> geometries_;  ///< indexed by Embree's geomID; never resized once Embree holds pointers
};

}  // namespace loom::reference
