// What becomes of the rays of a pixel. `unknown`, as shares: r leave the image, g end on a side that the camera does not
// see, b find nothing within the radius. `ended`: spherical harmonics of those that end.
#define HIDDEN_front 0
#define HIDDEN_far 1
#define HIDDEN_dark 2
#include "interop/frame.h"
#define RADIANCE 0
#if ENDED
const bool hidden_ends = HIDDEN != HIDDEN_far;
#endif
#include "lib/screen_rays.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
#if UNKNOWN
writeonly uniform image2D unknown_image;
#endif
#if ENDED
layout(rgba32f) writeonly uniform image2DArray ended_image;
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(surface_depth, 0)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 shares = vec3(0);
  if (depth > 0.) {
    uint seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x6e656172u);
    ScreenRays rays = screen_rays(camera, screen_point(camera, pixel, depth), seed, frame.random.z);
    float free = max(0., 1. - rays.front - rays.hidden - rays.outside - rays.under);
    shares = vec3(rays.outside, rays.hidden, free);
#if ENDED
    for (int i = 0; i < 3; ++i) imageStore(ended_image, ivec3(pixel, i), rays.ended[i]);
#endif
  }
#if UNKNOWN
  imageStore(unknown_image, pixel, vec4(shares, 1));
#endif
}
