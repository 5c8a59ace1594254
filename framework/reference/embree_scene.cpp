#include "reference/embree_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "loom/diagnostic.h"
#include "scene/texture.h"
#include "scene/world.h"

namespace loom::reference {
namespace {

template <class T>
T interpolate(const std::vector<T>& values, const std::uint32_t* corner, glm::vec2 uv) {
  return (1 - uv.x - uv.y) * values[corner[0]] + uv.x * values[corner[1]] + uv.y * values[corner[2]];
}

/// What materials are made of at a point of one triangle.
class MaterialPoint {
 public:
  MaterialPoint(const Geometry& geometry, const TrianglePoint& at)
      : geometry_(geometry), corner_(&geometry.primitive->indices[3U * at.triangle]), uv_(at.uv) {}

  /// One where there is no such texture.
  [[nodiscard]] glm::vec4 texture(const scene::TextureRef& ref, scene::Encoding encoding) const {
    const scene::Image* image = scene::image_of(*geometry_.scene, ref);
    if (image == nullptr) return glm::vec4(1);
    const scene::Primitive& primitive = *geometry_.primitive;
    const glm::vec2 uv = (1 - uv_.x - uv_.y) * scene::uv_of(primitive, ref, corner_[0]) +
                         uv_.x * scene::uv_of(primitive, ref, corner_[1]) +
                         uv_.y * scene::uv_of(primitive, ref, corner_[2]);
    return scene::sample(*image, ref, encoding, uv);
  }
  [[nodiscard]] glm::vec4 base_color() const {
    glm::vec4 color = geometry_.material->base_color;
    if (!geometry_.textured) return color;
    color *= texture(geometry_.material->base_color_texture, scene::Encoding::srgb);
    if (!geometry_.primitive->colors.empty()) color *= interpolate(geometry_.primitive->colors, corner_, uv_);
    return color;
  }
  [[nodiscard]] glm::vec3 albedo() const {
    float metallic = geometry_.material->metallic;
    if (geometry_.textured)
      metallic *= texture(geometry_.material->metallic_roughness_texture, scene::Encoding::linear).b;
    const glm::vec3 diffuse = glm::vec3(base_color()) * (1 - metallic);
    return geometry_.glossy ? diffuse * (1 - geometry_.material->transmission) : diffuse;
  }
  /// Of a glossy material: docs/specular.md.
  void set_specular(SurfacePoint& s) const {
    const scene::Material& m = *geometry_.material;
    float metallic = m.metallic, roughness = m.roughness;
    if (geometry_.textured) {
      const glm::vec4 texel = texture(m.metallic_roughness_texture, scene::Encoding::linear);
      metallic *= texel.b;
      roughness *= texel.g;
    }
    const float amplitude = (m.ior - 1) / (m.ior + 1);
    s.glossy = true;
    s.alpha = roughness * roughness;
    s.base_color = glm::vec3(base_color());
    s.f0 = glm::mix(glm::vec3(amplitude * amplitude), s.base_color, metallic);
    s.transmission = m.transmission * (1 - metallic);
    s.ior = m.ior;
  }
  [[nodiscard]] glm::vec3 emission() const {
    const glm::vec3 factor = geometry_.material->emissive;
    return geometry_.textured ? factor * glm::vec3(texture(geometry_.material->emissive_texture, scene::Encoding::srgb))
                              : factor;
  }
  [[nodiscard]] bool cut_out() const {
    return geometry_.material->alpha == scene::AlphaMode::mask && base_color().a < geometry_.material->least_alpha();
  }
  /// World space, of the file's own side; zero where the file's normals cancel.
  [[nodiscard]] glm::vec3 normal() const {
    const scene::Primitive& primitive = *geometry_.primitive;
    if (primitive.normals.empty()) return glm::vec3(0);
    const glm::vec3 n = geometry_.normal_matrix * interpolate(primitive.normals, corner_, uv_);
    const scene::TextureRef& map = geometry_.material->normal_texture;
    if (map.image < 0 || primitive.tangents.empty()) return n;
    const glm::vec4 tangent4 = interpolate(primitive.tangents, corner_, uv_);
    const glm::vec3 tangent = geometry_.linear * glm::vec3(tangent4);
    const glm::vec3 unit_n = normalized(n);
    const glm::vec3 unit_t = normalized(tangent - unit_n * glm::dot(unit_n, tangent));
    const float handedness = (tangent4.w < 0 ? -1.F : 1.F) * geometry_.orientation;
    const glm::vec3 bitangent = glm::cross(unit_n, unit_t) * handedness;
    const glm::vec3 m = glm::vec3(texture(map, scene::Encoding::linear)) * 2.F - 1.F;
    const float scale = geometry_.material->normal_scale;
    return unit_t * (m.x * scale) + bitangent * (m.y * scale) + unit_n * m.z;
  }
  /// Zero stays zero.
  static glm::vec3 normalized(const glm::vec3& v) {
    const float length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : glm::vec3(0);
  }

 private:
  const Geometry& geometry_;
  const std::uint32_t* corner_;
  glm::vec2 uv_;
};

/// Alpha test inside the traversal.
void reject_cut_out(const RTCFilterFunctionNArguments* args) {
  const auto& geometry = *static_cast<const Geometry*>(args->geometryUserPtr);
  const unsigned int n = args->N;
  for (unsigned int i = 0; i < n; ++i) {
    if (args->valid[i] != -1) continue;
    const TrianglePoint at{.triangle = RTCHitN_primID(args->hit, n, i),
                           .uv = {RTCHitN_u(args->hit, n, i), RTCHitN_v(args->hit, n, i)}};
    if (MaterialPoint(geometry, at).cut_out()) args->valid[i] = 0;
  }
}

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw Error("Embree ran out of memory while it built the scene");
  throw Error("Embree failed with error " + std::to_string(static_cast<int>(error)));
}

bool any_texture(const scene::Material& m) {
  return m.base_color_texture.image >= 0 || m.metallic_roughness_texture.image >= 0 || m.emissive_texture.image >= 0;
}

}  // namespace

EmbreeScene::EmbreeScene(const scene::Scene& scene, const glm::dvec3& origin) : device_(rtcNewDevice(nullptr)) {
  if (!device_) throw Error("Embree could not be started on this machine");
  embree_.reset(rtcNewScene(device_.get()));
  // Watertight edges: a closed furnace must not leak.
  rtcSetSceneFlags(embree_.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(embree_.get(), RTC_BUILD_QUALITY_MEDIUM);
  std::size_t count = 0;
  for (const auto& instance : scene.instances) {
    count += scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives.size();
  }
  geometries_.reserve(count);
  for (const auto& instance : scene.instances) {
    for (const auto& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives) {
      add(scene, instance, primitive, origin);
    }
  }
  rtcCommitScene(embree_.get());
  check(device_.get());
}

void EmbreeScene::add(const scene::Scene& scene, const scene::Instance& instance, const scene::Primitive& primitive,
                      const glm::dvec3& origin) {
  if (primitive.indices.size() < 3) return;
  if (*std::max_element(primitive.indices.begin(), primitive.indices.end()) >= primitive.positions.size()) {
    throw Error("a primitive of mesh " + std::to_string(instance.mesh) + " indexes past its vertices");
  }
  const glm::dmat3 linear(instance.world);
  const double determinant = glm::determinant(linear);
  Geometry g;
  g.scene = &scene;
  g.primitive = &primitive;
  g.material = &scene.materials[static_cast<std::size_t>(primitive.material)];
  g.linear = glm::mat3(linear);
  // Cofactors instead of the inverse: finite for a flattened instance too, and only the direction matters.
  g.normal_matrix = glm::mat3(
      glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1])) *
      (determinant < 0 ? -1. : 1.));
  g.orientation = determinant < 0 ? -1.F : 1.F;
  g.glossy = scene.surfaces == scene::SurfaceModel::ggx && g.material->glossy();
  g.textured = any_texture(*g.material) || !primitive.colors.empty();

  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), primitive.positions.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), primitive.indices.size() / 3));
  if (positions == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw Error("Embree ran out of memory while it took over the geometry");
  }
  const glm::dvec3 translation = glm::dvec3(instance.world[3]) - origin;
  std::transform(primitive.positions.begin(), primitive.positions.end(), positions,
                 [&](const glm::vec3& p) { return glm::vec3(linear * glm::dvec3(p) + translation); });
  std::copy(primitive.indices.begin(), primitive.indices.end() - primitive.indices.size() % 3, indices);
  g.positions = positions;
  geometries_.push_back(g);
  if (g.material->alpha == scene::AlphaMode::mask) {
    rtcSetGeometryUserData(geometry, &geometries_.back());
    rtcSetGeometryIntersectFilterFunction(geometry, reject_cut_out);
    rtcSetGeometryOccludedFilterFunction(geometry, reject_cut_out);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(embree_.get(), geometry, static_cast<unsigned int>(geometries_.size() - 1));
  rtcReleaseGeometry(geometry);
}

bool EmbreeScene::any_glossy() const {
  return std::any_of(geometries_.begin(), geometries_.end(), [](const Geometry& g) { return g.glossy; });
}

void EmbreeScene::intersect(const int* valid, RTCRayHit16& rays, bool coherent) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, embree_.get(), &context, &rays);
}

void EmbreeScene::occluded(const int* valid, RTCRay16& rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid, embree_.get(), &context, &rays);
}

void EmbreeScene::corners(const TrianglePoint& at, glm::vec3& a, glm::vec3& b, glm::vec3& c) const {
  const Geometry& g = geometries_[at.geometry];
  const std::uint32_t* corner = &g.primitive->indices[3U * at.triangle];
  a = g.positions[corner[0]];
  b = g.positions[corner[1]];
  c = g.positions[corner[2]];
}

glm::vec3 EmbreeScene::position(const TrianglePoint& at) const {
  glm::vec3 a, b, c;
  corners(at, a, b, c);
  return a + at.uv.x * (b - a) + at.uv.y * (c - a);
}

float EmbreeScene::offset(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  // Positions, barycentrics and the traversal each round at 2⁻²⁴ of the largest coordinate; 2⁻²⁰ covers their sum.
  const glm::vec3 m = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c)));
  return 0x1p-20F * std::max(m.x, std::max(m.y, m.z));
}

glm::vec3 EmbreeScene::emission(const TrianglePoint& at) const {
  const MaterialPoint material(geometries_[at.geometry], at);
  return material.cut_out() ? glm::vec3(0) : material.emission();
}

SurfacePoint EmbreeScene::surface(const TrianglePoint& at, const glm::vec3& direction) const {
  const Geometry& g = geometries_[at.geometry];
  const MaterialPoint material(g, at);
  glm::vec3 a, b, c;
  corners(at, a, b, c);
  SurfacePoint s;
  s.position = a + at.uv.x * (b - a) + at.uv.y * (c - a);
  s.offset = offset(a, b, c);
  const glm::vec3 front = MaterialPoint::normalized(glm::cross(b - a, c - a)) * g.orientation;
  const bool back_side = glm::dot(front, direction) > 0;
  s.geometric_normal = back_side ? -front : front;
  const glm::vec3 n = MaterialPoint::normalized(material.normal());
  s.normal = n == glm::vec3(0) ? s.geometric_normal : (back_side ? -n : n);
  s.albedo = material.albedo();
  if (g.glossy) {
    material.set_specular(s);
    s.inside = back_side;
  }
  if (g.first_emitter >= 0 && (!back_side || g.material->double_sided)) {
    s.emission = material.emission();
    s.emitter = g.first_emitter + static_cast<int>(at.triangle);
  }
  return s;
}

}  // namespace loom::reference
