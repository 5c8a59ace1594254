#pragma once
// Orbit and fly: how gestures move a camera. Pure geometry.
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"
#include "scene/world.h"

namespace loom::viewer {

/// Puts the target, which files often leave one metre ahead, at the depth of the scene's centre: the point to orbit.
void aim_at_scene(scene::Camera& camera, const scene::Box& box);
/// Turns the eye about the target; `turn` in radians to the right and up.
void orbit(scene::Camera& camera, glm::dvec2 turn);
/// Turns the view about the eye.
void look(scene::Camera& camera, glm::dvec2 turn);
/// Moves eye and target in the image plane, in shares of the image's height at the target.
void pan(scene::Camera& camera, glm::dvec2 share);
/// Brings the eye nearer to the target by a factor (an orthographic view grows).
void zoom(scene::Camera& camera, double factor);
/// Moves right, up and forward, metres.
void fly(scene::Camera& camera, const glm::dvec3& distance);

}  // namespace loom::viewer
