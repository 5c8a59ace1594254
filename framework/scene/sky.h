#pragma once
// A sky that is an image: radiance by direction, at an infinite distance.
//
// The image is equirectangular: its middle is towards −Z, its right towards +X, its top towards +Y. With the azimuth
// φ = atan2(x, −z) and the angle θ from +Y, a direction lies at u = φ/2π + ½ of the width from the left and v = θ/π of
// the height from the top. It is turned about +Y by `rotation_rad`, from +Z towards +X.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "loom/diagnostic.h"
#include "loom/export.h"

namespace loom::scene {

struct Scene;

struct SkyImage {
  int width = 0, height = 0;
  std::vector<glm::vec3> radiance;  ///< W/(m² sr), linear Rec.709; row 0 at the top
  double rotation_rad = 0;
  std::string source;  ///< the object of a run file that stands for it, as JSON

  /// Of the image, 0 to 1, as above, without the rotation.
  LOOM_API static glm::vec2 place_of(const glm::vec3& direction);
  LOOM_API static glm::dvec3 direction_of(glm::dvec2 place);
  [[nodiscard]] glm::vec3 texel(int x, int y) const {
    return radiance[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  /// Between the centres of texels it is linear in u and v, as the GPU's filter has it; unit `direction` of the world.
  [[nodiscard]] LOOM_API glm::vec3 at(const glm::vec3& direction) const;
  /// Solid angle of a texel of a row, sr: 2π/width·(cosθ_above − cosθ_below).
  [[nodiscard]] LOOM_API double solid_angle(int row) const;
  /// Over the sphere.
  [[nodiscard]] LOOM_API glm::vec3 mean() const;
  /// Of half the width and height (at least 1), means by solid angle.
  [[nodiscard]] LOOM_API SkyImage halved() const;
  /// ∫ L·Y dω up to a band, texel by texel, rotation included.
  [[nodiscard]] LOOM_API std::vector<glm::dvec3> harmonics(int order) const;
};

/// Makes it the scene's sky; `Scene::sky` becomes its mean.
LOOM_API void set_sky(Scene& scene, SkyImage image);

/// The sky's radiance from a unit direction of the world, W/(m² sr).
LOOM_API glm::vec3 sky_radiance(const Scene& scene, const glm::vec3& direction);
/// Its harmonics up to `order`.
LOOM_API std::vector<glm::dvec3> sky_harmonics(const Scene& scene, int order);
/// Shares of the bands 0, 1 and 2, and of all above, in the mean square of its radiance (mean of channels).
LOOM_API std::array<double, 4> sky_bands(const Scene& scene);

/// What stands for it in a run file, as JSON.
LOOM_API std::string sky_json(const Scene& scene);

/// What a run file says of the sky. One of three: `image`, `clear`, or neither (a constant).
struct SkyChoice {
  glm::vec3 radiance{0};
  std::string image;  ///< path of an .exr or .hdr file
  bool clear = false;
  double scale = 1, rotation_deg = 0;
  glm::dvec3 sun{0, 1, 0};  ///< unit, towards the sun
  double turbidity = 3;
  SourceLocation where;
};
/// Puts it into the scene. Throws BadInput where the image cannot be used; warns where negative values were cut off.
void apply_sky(Scene& scene, const SkyChoice& choice, Diagnostics& diagnostics);

/// The image of an .exr (channels R, G, B, or Y) or .hdr (Radiance RGBE) file. Throws BadInput.
SkyImage read_sky(const std::string& path, double scale, const SourceLocation& where, Diagnostics& diagnostics);
/// The clear sky of A. J. Preetham, P. Shirley and B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999,
/// without the sun's disc and black below the horizon. `sun`: unit, towards the sun. Its luminance in cd/m² over
/// 683 lm/W is the luminance of the radiance here, W/(m² sr).
LOOM_API SkyImage clear_sky(const glm::dvec3& sun, double turbidity, int height = 128);

}  // namespace loom::scene
