// Cube maps to spherical harmonics and back to irradiance, against what is known in closed form.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "../../passes/radiance_field/texel_weights.h"
#include "support/gl.h"
#include "support/render.h"
#include "support/run_compute.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int bands = 5, coefficients = bands * bands;
/// One conversion for all.
std::size_t index(int i) { return static_cast<std::size_t>(i); }
using Sh = std::array<double, coefficients>;

template <class Radiance>
Sh project(int size, const Radiance& radiance) {
  const std::vector<float> weights = field::texel_weights(size, bands);
  Sh c{};
  for (int t = 0; t < 6 * size * size; ++t) {
    const double l = radiance(field::texel_direction(size, t));
    for (int i = 0; i < coefficients; ++i) c.at(index(i)) += weights[index(t) * coefficients + index(i)] * l;
  }
  return c;
}

/// Some directions that favour no axis.
const std::array<glm::dvec3, 4> directions{glm::normalize(glm::dvec3(.3, -.5, .8)), glm::normalize(glm::dvec3(1, 1, 1)),
                                           glm::normalize(glm::dvec3(-.9, .2, .1)),
                                           glm::normalize(glm::dvec3(.1, .7, -.6))};

TEST(FieldProjection, SolidAnglesOfAllTexelsAreTheSphere) {
  for (const int size : {1, 2, 3, 8, 16, 32}) {
    double sum = 0;
    for (int row = 0; row < size; ++row)
      for (int column = 0; column < size; ++column)
        sum += field::rectangle_solid_angle(2. * column / size - 1, 2. * row / size - 1, 2. * (column + 1) / size - 1,
                                            2. * (row + 1) / size - 1);
    EXPECT_NEAR(6 * sum, 4 * pi, 1e-12) << size;
  }
}

TEST(FieldProjection, AConstantHasOneCoefficient) {
  for (const int size : {1, 8, 16}) {
    const Sh c = project(size, [](const glm::dvec3&) { return 2.5; });
    EXPECT_NEAR(c[0], 2.5 * std::sqrt(4 * pi), 1e-5);
    // Bands 1 to 3 vanish by the symmetry of the cube; band 4 has a cubic harmonic that one sample a texel integrates
    // with an error that falls by 4 with every doubling of the faces.
    for (std::size_t i = 1; i < 16; ++i) EXPECT_NEAR(c.at(i), 0, 1e-5) << size << ' ' << i;
    for (std::size_t i = 16; i < 25; ++i) EXPECT_NEAR(c.at(i), 0, 16. / (size * size)) << size << ' ' << i;
  }
}

TEST(FieldProjection, TheBasisIsOrthonormal) {
  constexpr int size = 32;
  for (int l = 0; l < bands; ++l) {
    for (int m = -l; m <= l; ++m) {
      const Sh c = project(size, [&](const glm::dvec3& w) { return field::spherical_harmonic(l, m, w); });
      for (int i = 0; i < coefficients; ++i)
        EXPECT_NEAR(c.at(index(i)), i == l * l + l + m ? 1 : 0, .003) << l << ' ' << m << ' ' << i;
    }
  }
}

TEST(FieldProjection, ValuesOfTheBasis) {
  for (const glm::dvec3& w : directions) {
    EXPECT_NEAR(field::spherical_harmonic(0, 0, w), .282095, 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(1, -1, w), .488603 * w.y, 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(1, 0, w), .488603 * w.z, 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(1, 1, w), .488603 * w.x, 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(2, -2, w), 1.092548 * w.x * w.y, 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(2, -1, w), 1.092548 * w.y * w.z, 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(2, 0, w), .315392 * (3 * w.z * w.z - 1), 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(2, 1, w), 1.092548 * w.x * w.z, 1e-6);
    EXPECT_NEAR(field::spherical_harmonic(2, 2, w), .546274 * (w.x * w.x - w.y * w.y), 1e-6);
  }
}

TEST(FieldProjection, AClampedCosineHasItsZonalCoefficientsWhereverItPoints) {
  constexpr std::array<double, bands> zonal{.886227, 1.023327, .495416, 0, -.110778};
  for (const glm::dvec3& axis : directions) {
    const Sh c = project(32, [&](const glm::dvec3& w) { return std::max(0., glm::dot(w, axis)); });
    for (int l = 0; l < bands; ++l) {
      // The zonal coefficient turns into z_l·√(4π/(2l+1))·Y_lm(axis), so that a band's power is z_l².
      double power = 0;
      for (int m = -l; m <= l; ++m) {
        const double value = c.at(index(l * l + l + m));
        power += value * value;
        EXPECT_NEAR(value, zonal.at(index(l)) * std::sqrt(4 * pi / (2 * l + 1)) * field::spherical_harmonic(l, m, axis),
                    .002);
      }
      EXPECT_NEAR(std::sqrt(power), std::abs(zonal.at(index(l))), .002) << l;
    }
  }
}

// A quarter turn takes texels to texels, so that nothing but the order of addition changes.
TEST(FieldProjection, AQuarterTurnTurnsTheCoefficients) {
  const auto light = [](const glm::dvec3& w) { return std::exp(2 * glm::dot(w, directions[0])) + (w.x > .2 ? 1 : 0); };
  const Sh c = project(8, light);
  const Sh turned = project(8, [&](const glm::dvec3& w) { return light({w.y, w.z, w.x}); });
  // f'(w) = f(P w): ∫ f(P w) Y(w) = ∫ f(v) Y(P⁻¹ v), P⁻¹ v = (v.z, v.x, v.y). Band 1: (x, y, z) comes from (z, x, y).
  EXPECT_NEAR(turned[0], c[0], 1e-5);
  EXPECT_NEAR(turned[3], c[2], 1e-5);
  EXPECT_NEAR(turned[1], c[3], 1e-5);
  EXPECT_NEAR(turned[2], c[1], 1e-5);
  for (int l = 2; l < bands; ++l) {
    double before = 0, after = 0;
    for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
      before += std::pow(c.at(index(i)), 2);
      after += std::pow(turned.at(index(i)), 2);
    }
    EXPECT_NEAR(after, before, 1e-5 * before) << l;
  }
}

// The fit is a projection: what is a sum of the Gaussians comes back as it is, but for one sample a texel.
TEST(FieldProjection, GaussiansFitASumOfThemselves) {
  constexpr int size = 16, n = field::gaussians;
  const std::vector<float> weights = field::gaussian_weights(size);
  std::array<double, n> fitted{};
  const auto amplitude = [](int i) { return .5 + i % 5; };
  for (int t = 0; t < 6 * size * size; ++t) {
    double l = 0;
    for (int i = 0; i < n; ++i) l += amplitude(i) * field::spherical_gaussian(i, field::texel_direction(size, t));
    for (int i = 0; i < n; ++i) fitted.at(index(i)) += weights[index(t) * n + index(i)] * l;
  }
  for (int i = 0; i < n; ++i) EXPECT_NEAR(fitted.at(index(i)), amplitude(i), 1e-4) << i;
}

class FieldShader : public GlTest {
 protected:
  /// What a shader function makes of the normals `directions`, `count` numbers each.
  std::vector<float> basis_values(const std::string& header, const std::string& function, int count) const {
    write_shader("basis.comp", "#define COEFFICIENTS " + std::to_string(count) + "\n#include \"" + header + R"("
layout(local_size_x = 1) in;
layout(std430) readonly buffer normals { vec4 n[]; };
layout(std430) writeonly buffer values { float v[]; };
void main() {
  float basis[COEFFICIENTS];
  )" + function + R"((n[gl_WorkGroupID.x].xyz, basis);
  for (int i = 0; i < COEFFICIENTS; ++i) v[int(gl_WorkGroupID.x) * COEFFICIENTS + i] = basis[i];
})");
    const auto device = make_device();
    const auto program = device->program({.files = {"basis.comp"}});
    std::vector<glm::vec4> normals;
    normals.reserve(directions.size());
    for (const glm::dvec3& n : directions) normals.emplace_back(glm::vec3(n), 0);
    const Buffer in = Buffer::of(std::span<const glm::vec4>(normals), "normals");
    std::vector<float> values(normals.size() * static_cast<std::size_t>(count));
    const Buffer out(values.size() * sizeof(float), "values");
    const EmptyScene scene;
    run_compute(*program, scene, {{"normals", &in}, {"values", &out}}, static_cast<unsigned int>(normals.size()));
    out.read(std::as_writable_bytes(std::span(values)));
    return values;
  }
};

// The shader's polynomials against the recurrence: A_l·Y_lm of every coefficient.
TEST_F(FieldShader, IrradianceBasisIsTheCosineKernelTimesTheBasis) {
  const std::vector<float> values = basis_values("lib/sh_bands.glsl", "sh_irradiance_basis", coefficients);
  constexpr std::array<double, bands> kernel{pi, 2 * pi / 3, pi / 4, 0, -pi / 24};
  for (std::size_t k = 0; k < directions.size(); ++k)
    for (int l = 0; l < bands; ++l)
      for (int m = -l; m <= l; ++m)
        EXPECT_NEAR(values[k * coefficients + index(l * l + l + m)],
                    kernel.at(index(l)) * field::spherical_harmonic(l, m, directions.at(k)), 2e-6)
            << l << ' ' << m;
}

// ∫ G_i(v)⟨n,v⟩₊ dv by cubes of 32², whose own error is 1e-4; the shader's sum ends before band 6, which holds up to
// π/64·13/2·I_6 = 3e-4.
TEST_F(FieldShader, IrradianceOfAGaussianIsItsIntegralOverTheHemisphere) {
  constexpr int size = 32, n = field::gaussians;
  const std::vector<float> values = basis_values("lib/spherical_gaussians.glsl", "sg_irradiance_basis", n);
  const std::vector<float> solid_angles = field::texel_weights(size, 1);  // times Y00
  for (std::size_t k = 0; k < directions.size(); ++k) {
    for (int i = 0; i < n; ++i) {
      double integral = 0;
      for (int t = 0; t < 6 * size * size; ++t) {
        const glm::dvec3 w = field::texel_direction(size, t);
        integral += solid_angles[index(t)] * std::sqrt(4 * pi) * field::spherical_gaussian(i, w) *
                    std::max(0., glm::dot(w, directions.at(k)));
      }
      EXPECT_NEAR(values[k * n + index(i)], integral, 1e-3) << k << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace loom::test
