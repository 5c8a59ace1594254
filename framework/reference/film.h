#pragma once
// The accumulation: sums and counts of every pixel, by replicate, in double. Saved, resumed and merged without loss.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/image_io.h"
#include "loom/export.h"

namespace loom::reference {

/// Independent scrambles a pixel. Their means are independent estimates, so their spread is the error of the whole;
/// the spread of single samples would overstate it, since low-discrepancy points are not independent.
inline constexpr int replicates = 16;

/// What one camera sample found.
struct Sample {
  glm::vec3 radiance{0};                       ///< W/(m² sr)
  glm::vec3 direct{0}, emitter{0}, bounce{0};  ///< irradiance, W/m²
  glm::vec3 specular{0};                       ///< the part of the radiance that the visible surface mirrors
  glm::vec3 albedo{0}, normal{0};
  float depth = 0;   ///< metres along the ray
  bool hit = false;  ///< false: the sky, all but radiance is zero
};

/// Sums over the samples of one pixel.
struct PixelSums {
  std::array<glm::dvec3, replicates> radiance{};
  glm::dvec3 direct{0}, emitter{0}, bounce{0}, albedo{0}, normal{0};
  double depth = 0;
  std::uint32_t count = 0;       ///< samples; sample s belongs to replicate s % 16
  std::uint32_t hits = 0;        ///< samples that met a surface
  std::uint32_t non_finite = 0;  ///< samples that were not finite and count as zero
  std::uint32_t unused = 0;
  glm::dvec3 specular{0};
};

/// What must agree for two accumulations to be of one picture.
struct FilmIdentity {
  std::uint64_t scene = 0;    ///< hash of scene, camera and image size
  std::int32_t bounces = -1;  ///< −1 = no limit
  bool operator==(const FilmIdentity&) const = default;
};

/// A quantity of the visible surface, as the EXR and the passes have it.
enum class Layer { radiance, direct, emitter, bounce, indirect, albedo, normal, specular };

class LOOM_API Film {
 public:
  Film() = default;
  Film(glm::ivec2 size, FilmIdentity identity, std::uint64_t seed);

  /// Row 0 is the top of the image.
  [[nodiscard]] PixelSums& pixel(int x, int y) { return pixels_[index(x, y)]; }
  [[nodiscard]] const PixelSums& pixel(int x, int y) const { return pixels_[index(x, y)]; }
  /// Adds the next sample of a pixel; the order of samples is the order of the calls.
  static void add(PixelSums& sums, const Sample& sample);

  [[nodiscard]] glm::ivec2 size() const { return size_; }
  [[nodiscard]] const FilmIdentity& identity() const { return identity_; }
  [[nodiscard]] const std::vector<std::uint64_t>& seeds() const { return seeds_; }
  /// Samples that every pixel has.
  [[nodiscard]] std::uint32_t least_count() const;
  /// Samples that some pixel has: more than least_count() while a round is under way.
  [[nodiscard]] std::uint32_t most_count() const;
  [[nodiscard]] std::uint64_t non_finite() const;
  /// Time spent so far, seconds; kept over interruptions.
  double seconds = 0;
  std::uint64_t rays = 0;

  /// Mean over the samples; 0 without any.
  [[nodiscard]] static glm::dvec3 mean(const PixelSums& sums, Layer layer = Layer::radiance);
  /// Standard error of the mean radiance, each channel; 0 below two samples, where nothing can be said.
  [[nodiscard]] static glm::dvec3 standard_error(const PixelSums& sums);
  /// Root of the relMSE that the standard errors predict: √ mean over pixels and channels of σ²/(mean²+1e-2).
  [[nodiscard]] double relative_error() const;

  /// All layers of the EXR: R G B, direct, emitter, bounce, indirect, albedo, normal, depth.Z, stderr; and specular,
  /// where something is.
  [[nodiscard]] ImageLayers layers() const;

  /// Adds `other`. Throws BadInput where it is of another picture, or holds a seed that is already in here.
  void merge(const Film& other);
  /// Written beside, then renamed. Throws Error.
  void save(const std::string& path) const;
  /// Throws BadInput where the file is missing, damaged or of another version.
  [[nodiscard]] static Film load(const std::string& path);

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(x);
  }

  glm::ivec2 size_{0};
  FilmIdentity identity_;
  std::vector<std::uint64_t> seeds_;
  std::vector<PixelSums> pixels_;
};

}  // namespace loom::reference
