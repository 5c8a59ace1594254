// A camera with its ray generator. `Surface` carries the one it was rendered with as its bundle struct.
#ifndef LOOM_INTEROP_CAMERA_H
#define LOOM_INTEROP_CAMERA_H
#include "interop/interop.h"
LOOM_INTEROP_BEGIN
struct Camera {
  mat4 view;
  mat4 proj;       // reversed depth: near 1, infinity 0
  mat4 view_proj;
  vec4 eye;        // xyz: world position, metres; w: 0 perspective, 1 orthographic
  // A ray through the point p of the image, p = (0,0) bottom left, (1,1) top right, with s = 2p − 1 + (right.w, up.w):
  //   perspective:  origin eye, direction normalize(forward + s.x·right + s.y·up)
  //   orthographic: origin eye + s.x·right + s.y·up, direction forward
  vec4 right;      // xyz: half the width of the image plane at distance 1 (orthographic: in metres)
  vec4 up;         // w of both: sub-pixel shift of the samples, in half-widths
  vec4 forward;    // xyz: unit viewing direction
  vec4 size;       // xy: pixels, zw: 1/pixels
};
LOOM_STRUCT_SIZE(Camera, 272);
LOOM_INTEROP_END
#endif
