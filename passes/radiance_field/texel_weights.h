#pragma once
// Projection of a cube of texels to spherical harmonics, as a table.
#include <vector>

#include <glm/vec3.hpp>

namespace field {

/// Real spherical harmonic Y_lm of a unit direction, without the Condon–Shortley phase, any l ≥ 0 and |m| ≤ l.
double spherical_harmonic(int l, int m, const glm::dvec3& direction);

/// Solid angle of the texel [x0,x1]×[y0,y1] of the plane at distance 1, sr, exact.
double rectangle_solid_angle(double x0, double y0, double x1, double y1);

/// Unit direction of the centre of texel t = (face·size + row)·size + column of a cube, as texel_direction() in
/// shaders/radiance_field/texels.glsl.
glm::dvec3 texel_direction(int size, int t);

/// How many spherical Gaussians make a field, and exp(λ(⟨direction,μ_i⟩ − 1)) of one of them, as in
/// shaders/lib/spherical_gaussians.glsl.
constexpr int gaussians = 12;
double spherical_gaussian(int i, const glm::dvec3& direction);

/// At [t·C + i], C = gaussians: what radiance 1 of texel t adds to the amplitude a_i of the Gaussians that fit the cube
/// best, Σ_t Δω_t (L(ω_t) − Σ_i a_i G_i(ω_t))² = min.
std::vector<float> gaussian_weights(int size);

/// Y_lm(ω_t)·Δω_t at [t·C + l² + l + m], C = bands².
std::vector<float> texel_weights(int size, int bands);

}  // namespace field
