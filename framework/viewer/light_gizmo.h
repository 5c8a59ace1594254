#pragma once
// Handles that move and turn a light in the picture. Pure geometry: what is where on the screen, and what a drag does.
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "interop/camera.h"
#include "scene/scene.h"
#include "scene/world.h"

namespace loom::viewer {

/// The picture's rectangle on the screen; y points down.
struct ScreenView {
  interop::Camera camera;
  glm::vec2 corner{0}, size{1};
};

/// Nothing for what is behind the camera.
std::optional<glm::vec2> on_screen(const ScreenView& view, const glm::dvec3& point);

struct Ray {
  glm::dvec3 origin{0}, direction{0, 0, -1};  ///< unit
};
Ray ray_through(const ScreenView& view, glm::vec2 at);

enum class HandleKind { centre, axis_x, axis_y, axis_z, direction };
struct Handle {
  HandleKind kind = HandleKind::centre;
  glm::vec2 at{0}, from{0};  ///< where it is taken, and where its line begins
};

/// Where a light's handles stand in the world: a directional light has no place, so that its handle is drawn in the
/// middle of the scene.
glm::dvec3 handle_centre(const scene::Light& light, const scene::Box& box);
/// Those of a light that can be seen: its centre, axes where it has a place, its direction where it has one.
std::vector<Handle> handles_of(const ScreenView& view, const scene::Light& light, const scene::Box& box);
/// The light after a handle was dragged from one place on the screen to another; nothing where that says nothing.
std::optional<scene::Light> dragged_light(const ScreenView& view, const scene::Light& light, const scene::Box& box,
                                          HandleKind kind, glm::vec2 from, glm::vec2 to);

}  // namespace loom::viewer
