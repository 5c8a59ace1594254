#pragma once
// The scene on the CPU, as loaded: what the GPU scene, the facts and the path tracer are made of. World units: metres.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/export.h"

namespace loom::scene {

struct SkyImage;

/// RGBA, 8 bits a channel, row 0 at the top, as stored in the file (sRGB or linear is the user's to know).
struct Image {
  std::string name;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

struct TextureRef {
  int image = -1;  ///< index into Scene::images, −1 = none
  int uv_set = 0;
  glm::mat3x2 transform{1, 0, 0, 1, 0, 0};  ///< uv' = transform · (u, v, 1); columns as glm has them
  bool repeat_u = true, repeat_v = true;    ///< false: clamp to edge. Mirrored repeat is in the image already
  bool nearest = false;
};

enum class AlphaMode { opaque, mask };

/// What light does at surfaces (docs/specular.md): diffuse alone, or glTF's metallic-roughness material.
enum class SurfaceModel { lambert, ggx };

struct Material {
  std::string name;
  glm::vec4 base_color{1};  ///< linear; a = alpha
  float metallic = 0, roughness = 1;
  float ior = 1.5F;        ///< KHR_materials_ior: index of refraction of the dielectric
  float transmission = 0;  ///< KHR_materials_transmission: share of its light that is refracted, not diffuse
  glm::vec3 emissive{0};   ///< emissiveFactor × strength: exitant radiance, W/(m² sr)
  float normal_scale = 1;
  float alpha_cutoff = .5f;
  /// Alpha from which a masked surface is there. A constant alpha that equals the cutoff passes, though interpolating
  /// it over a triangle rounds it by some units in the last place; 2⁻²⁰ bounds them.
  [[nodiscard]] float least_alpha() const { return alpha_cutoff * (1 - 0x1p-20f); }
  AlphaMode alpha = AlphaMode::opaque;
  bool double_sided = false;
  TextureRef base_color_texture;          ///< sRGB rgb, linear a
  TextureRef metallic_roughness_texture;  ///< linear: g roughness, b metallic
  TextureRef normal_texture;              ///< linear
  TextureRef emissive_texture;            ///< sRGB

  /// Whether it reflects as more than a diffuse surface under SurfaceModel::ggx: it is metal, smoother than rough or
  /// transparent, at some point. What is none of these is matte: diffuse alone.
  [[nodiscard]] bool glossy() const {
    return metallic > 0 || roughness < 1 || transmission > 0 ||
           (metallic_roughness_texture.image >= 0 && roughness > 0);
  }
};

/// Indexed triangles of one material. normals, uvs, colors and tangents are empty or as long as positions.
struct Primitive {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  ///< always filled: flat normals (unshared vertices) where the file has none
  std::vector<glm::vec2> uv0, uv1;
  std::vector<glm::vec4> colors;     ///< linear, multiplied into base_color
  std::vector<glm::vec4> tangents;   ///< w = ±1; made where a normal map needs them and the file has none
  std::vector<glm::u16vec4> joints;  ///< into Skin::joints; empty where no skin moves it
  std::vector<glm::vec4> weights;    ///< sum to 1
  /// What a skin starts from, in the mesh's own space; empty where no skin moves it. pose() writes positions, normals
  /// and tangents from these.
  std::vector<glm::vec3> rest_positions, rest_normals;
  std::vector<glm::vec4> rest_tangents;
  std::vector<std::uint32_t> indices;  ///< triples
  int material = 0;
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
};

struct Node {
  std::string name;
  int parent = -1;
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
  std::optional<glm::dmat4> matrix;  ///< replaces TRS where the file has one
  glm::dmat4 world{1};               ///< set by pose()
  int mesh = -1;                     ///< index into Scene::meshes
  int camera = -1;  ///< index into Scene::cameras: every node with a camera has one of its own, moved by pose()
  int light = -1;   ///< index into Scene::lights: likewise; −1 once a run file has replaced the lights
  int skin = -1;    ///< index into Scene::skins
};

struct Skin {
  std::vector<int> joints;
  std::vector<glm::dmat4> inverse_bind;
};

enum class LightKind { point, spot, directional };
struct Light {
  std::string name;
  LightKind kind = LightKind::point;
  glm::dvec3 position{0};
  glm::dvec3 direction{0, 0, -1};                       ///< unit, the way the light travels
  glm::vec3 intensity{1};                               ///< colour × intensity: W/sr, directional W/m²
  double inner_rad = 0, outer_rad = .7853981633974483;  ///< half-angles
};

struct Camera {
  std::string name;
  glm::dvec3 eye{0, 0, 0}, target{0, 0, -1}, up{0, 1, 0};
  bool orthographic = false;
  double yfov_rad = .6859;    ///< perspective
  double ymag = 1, xmag = 1;  ///< orthographic half-heights, metres; x follows the image's aspect where 0
  double znear = 0;           ///< 0: 1e-4 of the scene's diagonal
};

enum class Path { translation, rotation, scale };
enum class Interpolation { step, linear, cubic };
struct Channel {
  int node = 0;
  Path path = Path::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;
  std::vector<glm::vec4> values;  ///< three a key (in, value, out) where cubic
};
struct Animation {
  std::string name;
  std::vector<Channel> channels;
};

/// A mesh at its place, after pose(). An animation may scale `world` down to a singular matrix for a while.
struct Instance {
  int mesh = 0;
  int node = 0;
  glm::dmat4 world{1};
};

struct Scene {
  std::string path;
  /// What recentre() took off every position: `world` matrices, lights and cameras are relative to it. Nodes hold what
  /// the file says.
  glm::dvec3 origin{0};
  std::vector<Image> images;
  std::vector<Material> materials;  ///< at least one: index 0 exists even for an empty file
  std::vector<Mesh> meshes;         ///< skinned meshes are posed copies, one for each node that uses them
  std::vector<Node> nodes;          ///< parents before children
  std::vector<Skin> skins;
  std::vector<Animation> animations;
  std::vector<Instance> instances;
  std::vector<Light> lights;                  ///< world space, in order of appearance
  std::vector<Camera> cameras;                ///< world space
  glm::vec3 sky{0};                           ///< constant radiance, W/(m² sr); the image's mean where there is one
  std::shared_ptr<const SkyImage> sky_image;  ///< set_sky(); none: the sky is constant
  SurfaceModel surfaces = SurfaceModel::lambert;
  std::uint64_t content_hash = 0;  ///< of everything above
};

}  // namespace loom::scene
