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

/// Y_lm(ω_t)·Δω_t at [t·C + l² + l + m], C = bands².
std::vector<float> texel_weights(int size, int bands);

}  // namespace field
