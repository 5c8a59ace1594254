#pragma once
// How steady light is at fixed points of the world while the camera or a light moves.
#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "graph/run/renderer.h"
#include "interop/camera.h"
#include "loom/export.h"

namespace loom::measure {

/// The residual standard deviation of `values` about their least-squares parabola, over their mean: what is left when
/// the slow change that motion brings is taken away.
LOOM_API double flicker(const std::vector<double>& values);

/// Follows points that the first frame sees through all frames, by their irradiance (green).
class LOOM_API FlickerProbe {
 public:
  /// `depth`: metres along the ray, `irradiance`: both of one frame, row 0 at the top, one size.
  void add(const interop::Camera& camera, const graph::ReadImage& depth, const graph::ReadImage& irradiance);
  /// Root mean square of flicker() over the points that every frame sees; NaN where there is none.
  [[nodiscard]] double value() const;

 private:
  std::size_t frames_ = 0;
  std::vector<glm::dvec3> points_;
  std::vector<std::vector<double>> series_;
};

}  // namespace loom::measure
