#pragma once
// OpenGL state at the borders: of a pass, which begins from a known one, and of a frame, which leaves the program's.
#include <array>

#include "loom/export.h"

namespace loom::graph {

/// No blending, culling, scissor, stencil, logic operations or dithering; everything written; depth test off with
/// GREATER; clip space z in [0, 1], y up; counter-clockwise fronts, filled; seamless cubemaps.
LOOM_API void set_known_state();

/// Restores, when destroyed, what a frame changes and a program is likely to rely on: program, framebuffers, vertex
/// array, viewport, the capabilities and functions of set_known_state(). Not restored: textures, samplers, images and
/// buffers at their binding points.
class LOOM_API SavedState {
 public:
  SavedState();
  ~SavedState();
  SavedState(const SavedState&) = delete;
  SavedState& operator=(const SavedState&) = delete;

 private:
  static constexpr int capability_count = 13;
  std::array<bool, capability_count> enabled_{};
  int program_ = 0, draw_framebuffer_ = 0, read_framebuffer_ = 0, vertex_array_ = 0, indirect_ = 0, active_texture_ = 0;
  std::array<int, 4> viewport_{};
  std::array<int, 6> blend_{};  ///< functions of colour and alpha, equations
  std::array<unsigned char, 4> color_mask_{};
  unsigned char depth_mask_ = 1;
  int depth_function_ = 0, front_face_ = 0, clip_origin_ = 0, clip_depth_ = 0;
  std::array<int, 2> polygon_mode_{};
};

}  // namespace loom::graph
