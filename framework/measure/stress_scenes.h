#pragma once
// Scenes at the extremes, made of few triangles: what the stress cases render.
#include <functional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "loom/export.h"
#include "scene/scene.h"

namespace loom::measure {

/// A closed room, 3.63 × 2.93 × 4 m, with a block on its floor. Every member is one way to bend it.
struct Room {
  double unit = 1;  ///< positions × unit, point and spot lights × unit²: the picture stays the same
  glm::dvec3 offset{0};
  int quarter_turns = 0;  ///< of everything, camera too, about the y axis
  float albedo = .6f;
  int lights = 1;             ///< points in a ring under the ceiling
  float intensity = 3;        ///< W/sr, of each
  double light_step = 0;      ///< metres along x
  float lamp = -1;            ///< exitant radiance of a square in the ceiling, W/(m² sr); below 0 = there is no square
  bool open = false;          ///< without the wall behind the camera
  float sky = 0;              ///< radiance, W/(m² sr)
  double divider = 0;         ///< thickness in metres of a wall across the middle; 0 = there is none
  bool orthographic = false;  /// camera
};

/// A scene with the camera that looks at it.
struct View {
  scene::Scene scene;
  scene::Camera camera;
};

LOOM_API View make_room(const Room& room);

/// A view with a name, made where it is asked for.
struct NamedView {
  std::string name;
  std::function<View()> make;
};

/// Scenes with something degenerate in them: nothing, one triangle, needles, NaN, a light inside a wall.
LOOM_API std::vector<NamedView> odd_scenes();

/// An upper bound of the radiance anywhere in the scene, whatever the number of reflections: (L_e + ρ/π·E) / (1 − ρ)
/// with the largest emission (or sky), albedo and straight irradiance. Infinite for an albedo of 1, and where a light
/// touches a surface.
LOOM_API double furnace_bound(const scene::Scene& scene);

}  // namespace loom::measure
