#pragma once
// Where photons landed, and the density of those about a point.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "reference/embree_scene.h"

namespace loom::reference {

/// Which irradiance a photon is of.
enum class Kind : std::uint8_t { direct, emitter, bounce };

struct Photon {
  glm::vec3 position, direction, normal;
  glm::vec3 flux;
  int order;  ///< surfaces that sent it on
  Kind kind;
  bool caustic;  ///< from a punctual light by way of nothing but specular lobes: no path from the eye meets its source
};

/// ⟨n,ω⟩₊/⟨n_g,ω⟩ for light that travels along `direction`.
inline float shading_ratio(const glm::vec3& normal, const glm::vec3& geometric, const glm::vec3& direction) {
  return std::max(0.F, -glm::dot(normal, direction)) / std::max(1e-3F, -glm::dot(geometric, direction));
}

/// Photons sorted into cells no smaller than the disc, so that eight hold all that a disc may reach.
class PhotonMap {
 public:
  PhotonMap(const std::vector<std::vector<Photon>>& parts, const glm::vec3& low, const glm::vec3& high, float radius)
      : low_(low), radius_(radius) {
    const glm::vec3 extent = high - low;
    const float longest = std::max(extent.x, std::max(extent.y, extent.z));
    size_ = std::max({2 * radius, longest / most_cells, std::numeric_limits<float>::min()});
    for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<int>(extent[axis] / size_) + 1;
    first_.assign(at(cells_.x) * at(cells_.y) * at(cells_.z) + 1, 0);
    for (const auto& part : parts) {
      for (const Photon& photon : part) ++first_[cell_of(photon.position) + 1];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    photons_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const auto& part : parts) {
      for (const Photon& photon : part) photons_[next[cell_of(photon.position)]++] = photon;
    }
  }

  /// visit(photon, d) for the photons within the disc about x: irradiance is Σ Φ·d, with d in 1/m².
  template <class Visit>
  void visit(const SurfacePoint& x, const Visit& visit) const {
    const float scale = 1 / (std::numbers::pi_v<float> * radius_ * radius_);
    const glm::ivec3 first = cell(x.position - radius_), last = cell(x.position + radius_);
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int i = first.x; i <= last.x; ++i) {
          const std::size_t c = index({i, y, z});
          for (std::size_t k = first_[c]; k < first_[c + 1]; ++k) {
            const Photon& photon = photons_[k];
            if (!same_surface(x, photon)) continue;
            visit(photon, shading_ratio(x.normal, photon.normal, photon.direction) * scale);
          }
        }
      }
    }
  }

 private:
  static constexpr int most_cells = 128;  ///< along an axis
  /// Photons on a plane turned by more than this cosine are another surface's, as are those this share of r off the
  /// plane.
  static constexpr float same_normal = .9F, same_plane = .25F;

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] bool same_surface(const SurfacePoint& x, const Photon& photon) const {
    const glm::vec3 d = photon.position - x.position;
    if (glm::dot(d, d) > radius_ * radius_) return false;
    if (glm::dot(photon.normal, x.geometric_normal) < same_normal) return false;
    return std::abs(glm::dot(d, x.geometric_normal)) <= same_plane * radius_ + x.offset;
  }
  [[nodiscard]] glm::ivec3 cell(const glm::vec3& p) const {
    const glm::vec3 w = (p - low_) / size_;
    return glm::clamp(glm::ivec3(glm::floor(w)), glm::ivec3(0), cells_ - 1);
  }
  [[nodiscard]] std::size_t index(const glm::ivec3& c) const {
    return at(c.x) + at(cells_.x) * (at(c.y) + at(cells_.y) * at(c.z));
  }
  [[nodiscard]] std::size_t cell_of(const glm::vec3& p) const { return index(cell(p)); }

  glm::vec3 low_;
  float radius_, size_ = 0;
  glm::ivec3 cells_{1};
  std::vector<std::size_t> first_;
  std::vector<Photon> photons_;
};

}  // namespace loom::reference
