#include "reference/camera_hits.h"

#include <glm/geometric.hpp>

namespace loom::reference {

glm::vec3 camera_ray(const interop::Camera& camera, glm::ivec2 pixel, glm::vec2 inside, glm::vec3& eye) {
  const bool orthographic = camera.eye.w != 0;
  const glm::vec2 size(camera.size.x, camera.size.y);
  const float a = 2 * (static_cast<float>(pixel.x) + inside.x) / size.x - 1;
  const float b = 1 - 2 * (static_cast<float>(pixel.y) + inside.y) / size.y;
  const glm::vec3 plane = glm::vec3(camera.right) * a + glm::vec3(camera.up) * b;
  eye = glm::vec3(camera.eye) + (orthographic ? plane : glm::vec3(0));
  return glm::normalize(glm::vec3(camera.forward) + (orthographic ? glm::vec3(0) : plane));
}

}  // namespace loom::reference
