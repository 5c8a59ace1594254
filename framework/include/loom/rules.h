#pragma once
// "Model only what the scene requires": the rules by which passes leave out what a scene does not need. Each is a pure
// function of the scene's facts, with its threshold, the evidence that it goes by, and why the picture stays the same,
// or how far it may move. `--no-prune` switches them all off, `--no-prune=NAME` one; docs/pruning.md has the
// measurements.
//
// Some need no function, since the fact decides alone:
//   no-emission    no triangle emits, the sky is black: zero is not stored, not traced and not added. The same bits.
//   no-specular    surfaces are ggx, and none in use is metal, smoother than rough or transparent: F₀ is 0 everywhere.
//                  The same bits.
//   no-alpha       no material is masked: nothing is discarded. The same bits.
//   no-normal-map  no material has one: the tangent frame is not read. The same bits.
//   static         nothing moves: Ports::keep_outputs() holds. A pass runs again when its parameters, what its wires
//                  bring or its fingerprint (versions of the scene, seed) change; what it would make is a function of
//                  these alone. The same bits.
//   sleeping-probes  a pass knows whose pixels read its probes: others are not made. What interpolation can touch is
//                  awake. The same bits.
//   unread         nobody reads a pass, an output or a member. The same bits.
#include <initializer_list>
#include <string>

#include <glm/vec3.hpp>

#include "loom/export.h"
#include "loom/facts.h"
#include "loom/ports.h"

namespace loom::rules {

/// `achromatic`: how many channels the light of this scene takes, 1 or 3.
///   threshold  chroma, (max − min)/max over the channels of a colour, of at most 2⁻¹¹: what half floats round by
///   evidence   SceneFacts::max_chroma: lights, albedo (textures and vertex colours included), emission, sky
///   proof      Light is a sum of products of non-negative colours: of one source and of an albedo a reflection. Where
///   c
///              is the largest chroma of a factor, the channels of a product of k of them differ by a share of
///              1−(1−c)ᵏ ≤ k·c at most, and a sum by no more than its worst term. All channels go through the same
///              operations: red has the bits that it has among three. So c = 0 gives the same bits, and after n
///              reflections the others are off by at most (n+2)·2⁻¹¹ of themselves.
inline constexpr double achromatic_threshold = 0x1p-11;
LOOM_API int channels(const Ports& ports, const SceneFacts& facts);

/// The same for what a pass makes of its inputs: as many channels as the widest of them that carries anything brings.
LOOM_API int channels(std::initializer_list<InputPort> inputs);

/// `bounces`: orders of reflection after which nothing is left that counts; INT_MAX where there is no such number.
///   threshold  a share of 1e-3 of all light
///   evidence   the largest albedo ρ: SceneFacts::max_albedo where the scene itself reflects, the attribute
///   `max_albedo`
///              of what a wire brings (1 where it has none)
///   proof      A surface reflects at most ρ of the flux that arrives, so that all light from order n+1 on is at most
///              ρⁿ⁺¹ of all light: n is the smallest with ρⁿ⁺¹ < 1e-3. That is a bound of flux over all surfaces. With
///              ρ = 1 there is none, and the pass's own parameter ends the series.
inline constexpr double bounces_threshold = 1e-3;
LOOM_API int bounces(const Ports& ports, double max_albedo);
/// Says what came of it, for a pass whose parameter allows `allowed` orders.
LOOM_API void decide_bounces(Ports& ports, double max_albedo, int allowed);
LOOM_API double max_albedo(const InputPort& input);

/// `iterations`: steps of light propagation over at most `cells` cells between sender and receiver.
///   threshold  2k², no less than 1
///   evidence   the cells of the grid, but for the empty ones around it
///   proof      Propagation is a random walk: after 2k² steps what set out has spread over k cells, and most of what
///              still goes on has been through every cell. The rest is measured, not bounded: docs/pruning.md.
LOOM_API int iterations(const Ports& ports, int cells);
/// Says what came of it where `allowed` steps are set. Where 2k² is more than 64, steps are the wrong means: it asks
/// for a coarser cascade.
LOOM_API void decide_iterations(Ports& ports, int cells, int allowed);

/// `bands`: the order of spherical harmonics, up to `allowed`, that irradiance from this scene's light takes.
///   threshold  the bands above it hold less than 1e-3 of the mean square of irradiance (3 % of its root)
///   evidence   SceneMeasurements::radiance, by `loom analyse`; without it nothing is left out
///   proof      Irradiance is radiance convolved with the clamped cosine: band l of its mean square is A_l² times that
///              of radiance, and bands are orthogonal. So what is left out is what the bands above hold, at the probes
///              where it was measured.
inline constexpr double bands_threshold = 1e-3;
LOOM_API int bands(Ports& ports, const SceneFacts& facts, int allowed);
/// The share of the mean square of irradiance in the bands above `order`.
LOOM_API double above_band(const SceneMeasurements& measured, int order);

struct Bounds {
  glm::dvec3 low, high;  ///< metres
};
/// `bounds`: the box that volumes have to hold.
///   threshold  the lit box has less than half of the scene's volume, and nothing moves
///   evidence   SceneMeasurements::lit_min … lit_max, by `loom analyse`; without it the box of all geometry
///   proof      What no light reaches is black, and reflects nothing. The lit box leaves out 1e-3 of all reflected
///   light
///              at most, and the cells that it frees lie where the light is. It is another grid: how far the picture
///              moves is measured, docs/pruning.md.
LOOM_API Bounds bounds(const Ports& ports, const SceneFacts& facts);
/// "box of …", for the evidence of a decision.
LOOM_API std::string bounds_text(const Ports& ports, const SceneFacts& facts);

}  // namespace loom::rules
