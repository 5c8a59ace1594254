#pragma once
// Grids whose content a test writes, propagated by LPV.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/grid.h"
#include "loom/diagnostic.h"
#include "loom/pass.h"
#include "plugins/loader.h"
#include "support/render.h"

namespace loom::test {

inline constexpr double pi = std::numbers::pi;

/// SH coefficients (c00, c1−1, c10, c11) of the lobe Φ/π·⟨n,ω⟩₊ of flux 1 W.
inline glm::vec4 unit_lobe(glm::vec3 n) {
  constexpr float z0 = .88622693F, z1 = 1.02332671F;
  return glm::vec4(z0, z1 * n.y, z1 * n.z, z1 * n.x) / static_cast<float>(pi);
}

/// What the fake source puts into nested grids of n³ cells: finest first, cells of 1, 2, 4 … metres, corners at the
/// origin until a test moves them.
struct Field {
  int n, cascades;
  interop::Grid grid{};
  std::vector<glm::vec4> red;        // coefficients, x fastest
  std::vector<glm::vec4> occupancy;  // of the three lower faces
  std::vector<glm::vec4> albedo;     // of the x faces, the y faces, the z faces
  std::vector<glm::vec4> directional;
  explicit Field(int cells, int count = 1)
      : n(cells),
        cascades(count),
        red(static_cast<std::size_t>(cells * cells * cells * count)),
        occupancy(red.size()),
        albedo(3 * red.size(), glm::vec4(.5F)),
        directional(red.size()) {
    grid.cells = {n, n, n, count};
    for (int k = 0; k < count; ++k) grid.cascade[k] = {0, 0, 0, static_cast<float>(1 << k)};
  }
  [[nodiscard]] std::size_t at(int x, int y, int z, int cascade = 0) const {
    return static_cast<std::size_t>(x + n * (y + n * (z + n * cascade)));
  }
};

class LpvTest : public RenderTest {
 protected:
  void SetUp() override {
    RenderTest::SetUp();
    if (IsSkipped()) return;
    load_passes();
  }

  void load_passes() {
    Diagnostics diagnostics;
    plugins::load_plugins({.dirs = {LOOM_BINARY_DIR "/lib/loom/passes"}, .installed = false}, registry_, diagnostics);
    ASSERT_FALSE(diagnostics.has_errors());
  }

  /// Registers `Source` (flux and blockers of `field`) for this test.
  void add_source(const Field& field) {
    add_pass(registry_, "Source", [&field] {
      return PassFunctions{.reflect = [&field](Ports& ports) { declare(field, ports); },
                           .execute = [&field](Frame&, const Bindings& io) { fill(field, io); }};
    });
  }

  /// Coefficients of the red channel after propagation.
  std::vector<glm::vec4> propagate(bool blockers, int iterations, int bounces = 1, const std::string& more = "") {
    const std::string pipeline = R"({"passes": {
      "source": {"type": "Source"},
      "lpv": {"type": "LPV", "in": {"flux": "source.flux")" +
                                 std::string(blockers ? R"(, "blockers": "source.blockers")" : "") +
                                 R"(}, "params": {"iterations": )" + std::to_string(iterations) + R"(, "bounces": )" +
                                 std::to_string(bounces) + more + R"(}}},
      "outputs": {"image": "lpv.intensity.red"}})";
    // Tests ask what so many steps do.
    const auto renderer = make(pipeline, {}, {.disabled_rules = {"iterations"}});
    frame(*renderer);
    return renderer->output("image")->read();
  }

  /// Flux of the cells for which `keep` holds: ∫ I dω = 2√π·c00.
  template <class Keep>
  static double flux(const Field& field, const std::vector<glm::vec4>& cells, Keep keep) {
    double sum = 0;
    for (int z = 0; z < field.n; ++z)
      for (int y = 0; y < field.n; ++y)
        for (int x = 0; x < field.n; ++x)
          if (keep(x, y, z)) sum += 2 * std::sqrt(pi) * cells[field.at(x, y, z)].x;
    return sum;
  }
  static double total(const Field& field, const std::vector<glm::vec4>& cells) {
    return flux(field, cells, [](int, int, int) { return true; });
  }

 private:
  static void declare(const Field& field, Ports& ports) {
    TextureDesc volume = TextureDesc::volume(field.n, Format::rgba32f);
    volume.depth *= field.cascades;
    auto flux = ports.out("flux", "ShVolume").attribute("cascades", field.cascades);
    for (const char* channel : {"red", "green", "blue"}) flux.texture(channel, volume, Access::image_write);
    auto blockers = ports.out("blockers", "VoxelScene").attribute("cascades", field.cascades);
    volume.filter = Filter::nearest;
    blockers.texture("occupancy", volume, Access::image_write);
    blockers.texture("directional", volume, Access::image_write);
    volume.depth *= 3;
    blockers.texture("albedo", volume, Access::image_write);
  }

  static void fill(const Field& field, const Bindings& io) {
    const auto write = [&](const std::string& member, const std::vector<glm::vec4>& texels) {
      if (io.has(member)) io.texture(member).write(std::as_bytes(std::span(texels)));
    };
    io.publish("flux", field.grid);
    io.publish("blockers", field.grid);
    for (const char* channel : {"red", "green", "blue"}) write("flux." + std::string(channel), field.red);
    write("blockers.occupancy", field.occupancy);
    write("blockers.directional", field.directional);
    write("blockers.albedo", field.albedo);
  }
};

}  // namespace loom::test
