#pragma once
// What reflect() may know of a scene: static facts, plain data, computed once when the scene is loaded.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

namespace loom {

/// What has to be measured by rays: once a scene, by `loom analyse`, and kept by content hash (docs/pruning.md).
struct SceneMeasurements {
  static constexpr std::size_t bands = 9;  ///< of spherical harmonics: 0 … 8
  glm::dvec3 lit_min{0};                   ///< box of the surfaces that light reaches, straight or reflected, metres
  glm::dvec3 lit_max{0};
  glm::dvec3 seen_min{0};  ///< of those that the camera sees
  glm::dvec3 seen_max{0};
  /// Metres; a hundredth of the surface stands on something thinner. 0: nothing has an inside.
  double thinnest_occluder = 0;
  double sheets = 0;                       ///< share of the surface that has no inside: it is infinitely thin
  std::array<double, bands> radiance{};    ///< share of each band in the mean square of reflected light, at probes
  std::array<double, bands> visibility{};  ///< the same of what a probe sees within a tenth of the scene: 1 or 0
  int probes = 0;                          ///< that stood in free space
  bool operator==(const SceneMeasurements&) const = default;
};

struct SceneFacts {
  int spot_lights = 0;         ///< half-angle ≤ 60°: one light face each
  int wide_spot_lights = 0;    ///< half-angle over 60°: six faces
  int point_lights = 0;        ///< six faces each
  int directional_lights = 0;  ///< one face each
  /// Faces over all lights: how many layers a LightLayers bundle has.
  [[nodiscard]] int light_faces() const {
    return spot_lights + 6 * wide_spot_lights + 6 * point_lights + directional_lights;
  }
  [[nodiscard]] int lights() const { return spot_lights + wide_spot_lights + point_lights + directional_lights; }

  bool sky = false;        ///< sky radiance is not black
  bool sky_image = false;  ///< it is an image: radiance by direction (shaders/lib/sky.glsl)
  /// Shares of the bands 0, 1 and 2, and of all above, in the mean square of the sky's radiance.
  std::array<double, 4> sky_bands{};
  int emissive_triangles = 0;  ///< triangles of materials that emit
  bool emissive_textures = false;
  double emissive_area = 0;  ///< m² of those triangles, both sides where a material is double-sided
  double emitted_power = 0;  ///< W, mean over channels: Σ π·L·A
  bool alpha_mask = false;   ///< some material has alphaMode MASK (or BLEND, read as MASK at .5)
  bool normal_maps = false;
  bool ggx = false;           ///< surfaces reflect as glTF's metallic-roughness material; else all are diffuse
  bool specular = false;      ///< `ggx`, and some material in use is metal, smoother than rough or transparent
  bool transmission = false;  ///< `ggx`, and some material in use is transparent
  bool textures = false;
  bool geometry_moves = false;  ///< the animation moves or bends something that is drawn
  bool lights_move = false;
  bool camera_moves = false;    ///< a camera of the file; the program that embeds may move any
  bool moves = false;           ///< geometry or lights: what light reaches changes
  double max_chroma = 0;        ///< largest (max−min)/max over light, albedo, emission and sky: 0 = achromatic
  double max_albedo = 0;        ///< ρ_max over channels
  double max_emission = 0;      ///< W/(m² sr), over channels and materials in use
  double thinnest_feature = 0;  ///< metres; smallest extent of a mesh's box that is not zero
  glm::dvec3 bounds_min{0};     ///< world box of all geometry at all times of the animation, metres
  glm::dvec3 bounds_max{0};
  std::size_t triangles = 0;
  std::size_t moving_triangles = 0;  ///< of them, those that the animation can move
  std::uint64_t content_hash = 0;
  std::optional<SceneMeasurements> measured;
};

}  // namespace loom
