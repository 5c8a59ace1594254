#pragma once
// What reflect() may know of a scene: static facts, plain data, computed once when the scene is loaded.
#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

namespace loom {

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

  bool sky = false;            ///< sky radiance is not black
  int emissive_triangles = 0;  ///< triangles of materials that emit
  bool emissive_textures = false;
  bool alpha_mask = false;  ///< some material has alphaMode MASK (or BLEND, read as MASK at .5)
  bool normal_maps = false;
  bool textures = false;
  bool moves = false;           ///< an animation, a skin or a script can change geometry, lights or camera
  double max_chroma = 0;        ///< largest (max−min)/max over light, albedo, emission and sky: 0 = achromatic
  double max_albedo = 0;        ///< ρ_max over channels
  double max_emission = 0;      ///< W/(m² sr), over channels and materials in use
  double thinnest_feature = 0;  ///< metres; smallest extent of a mesh's box that is not zero
  glm::dvec3 bounds_min{0};     ///< world box of all geometry, over the whole animation, metres
  glm::dvec3 bounds_max{0};
  std::size_t triangles = 0;
  std::size_t moving_triangles = 0;  ///< of them, those that the animation can move
  std::uint64_t content_hash = 0;
};

}  // namespace loom
