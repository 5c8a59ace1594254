// The uniform block frame_data, bound by every program that names it.
#ifndef LOOM_INTEROP_FRAME_H
#define LOOM_INTEROP_FRAME_H
#include "interop/camera.h"
LOOM_INTEROP_BEGIN
struct FrameData {
  Camera camera;
  uvec4 random;    // x: seed, y: frame index, z: sub-pixel sample, w: samples a pixel
  vec4 time;       // x: seconds, y: seconds since the last frame
  vec4 sky;        // rgb: radiance of the sky, W/(m² sr), or its mean; w: by how many turns its image is turned
};
LOOM_STRUCT_SIZE(FrameData, 320);
LOOM_INTEROP_END
#endif
