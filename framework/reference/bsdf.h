#pragma once
// What light does at a point of a surface: glTF's metallic-roughness material (docs/specular.md).
//   f = (1−τ)·F·D·G₂/(4 μ_v μ_l) + ρ/π·(1−E(μ_v))(1−E(μ_l))/(1−E_avg) + τ·glass
// with τ the share that is glass: transmission of what is not metal. The second term is diffuse light under a specular
// coat (Kelemen and Szirmay-Kalos 2001; Kulla and Conty 2017): symmetric, and with the first it reflects
// E + ρ(1−E) ≤ 1 of uniform light. Glass reflects by Fresnel's equations and refracts the rest.
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "loom/export.h"
#include "reference/embree_scene.h"

namespace loom::reference {

/// Which of a surface's light is meant.
enum class Lobes { diffuse, specular, all };

struct BsdfSample {
  glm::vec3 direction{0};  ///< unit, from the surface
  glm::vec3 weight{0};     ///< f·cos over the density; 0: the path ends
  /// Per solid angle; 0 where light samples cannot find the direction: mirrored and refracted ones.
  float density = 0;
};

/// A photon's next leg: where it goes, and its flux there over what it was.
struct FluxSample {
  glm::vec3 direction{0};  ///< unit, from the surface
  glm::vec3 weight{0};     ///< 0: the photon ends
  bool specular = false;   ///< by the specular lobes; else by the diffuse one
};

class LOOM_API Bsdf {
 public:
  /// `to_viewer`: unit, from the surface.
  Bsdf(const SurfacePoint& at, const glm::vec3& to_viewer);

  [[nodiscard]] bool has_specular() const { return at_.glossy; }
  /// f, 1/sr, without the cosine, for a direction on the side of the viewer; without what is a mirror.
  [[nodiscard]] glm::vec3 evaluate(const glm::vec3& direction, Lobes lobes) const;
  /// Of sample(), per solid angle; without what is a mirror.
  [[nodiscard]] float density(const glm::vec3& direction, Lobes lobes) const;
  /// `u`: the direction; `choice`: which lobe, and whether glass reflects.
  [[nodiscard]] BsdfSample sample(Lobes lobes, glm::vec2 u, glm::vec2 choice) const;
  /// The same the other way: light comes from where the viewer was.
  [[nodiscard]] FluxSample sample_flux(glm::vec2 u, glm::vec2 choice) const;

 private:
  [[nodiscard]] glm::vec3 diffuse(const glm::vec3& direction) const;
  /// Share of light about the microfacet normal that the surface reflects: coat and glass together.
  [[nodiscard]] glm::vec3 fresnel(float cosine) const;
  /// The chance that sample() reflects, not refracts, about a microfacet at this cosine.
  [[nodiscard]] float reflects(float cosine) const;
  [[nodiscard]] BsdfSample sample_specular(glm::vec2 u, float choice) const;
  /// Probability that `lobes` are sampled by the specular ones.
  [[nodiscard]] float specular_share(Lobes lobes) const;
  [[nodiscard]] bool mirror() const;

  const SurfacePoint& at_;
  glm::vec3 to_viewer_;
  glm::mat3 frame_{1};       ///< columns: tangents and the normal of the specular lobes
  glm::vec3 view_{0, 0, 1};  ///< in that frame, above the surface
  glm::vec3 albedo_{0};      ///< E(μ_v)
  float glass_ = 0;          ///< τ
  float eta_ = 1;            ///< index behind the surface over the index in front
};

}  // namespace loom::reference
