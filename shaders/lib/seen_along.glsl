// What a ray brings: from the picture where that shows what it meets, else from the voxels, else from the sky.
// The including file declares `frame`, `camera`, and what lib/screen_march.glsl needs, and defines
//   PICTURE  1 where the input `picture` (Image) shows what surfaces send
//   VOXELS   1 where the input `voxels` holds the scene, with LIGHT and EMISSION as exitant_sheets.glsl has them
#ifndef LOOM_LIB_SEEN_ALONG_GLSL
#define LOOM_LIB_SEEN_ALONG_GLSL
#include "lib/sky.glsl"
#if PICTURE
#include "lib/screen_march.glsl"
uniform sampler2D picture_image;
#endif
#if VOXELS
#include "lib/exitant_sheets.glsl"
#include "lib/voxels.glsl"
#endif

// Of the rays of a pixel: x found in the picture, y left it, z lost in it; w: all.
vec4 ray_ends = vec4(0);

// As march_screen().
vec3 seen_along(vec3 x, vec3 w, vec3 n, float extent, float within) {
  float free = 0.;
  ray_ends.w += 1.;
#if PICTURE
  ScreenMarch screen = march_screen(camera, x, w, n, extent, within);
  if (screen.end == SCREEN_FOUND) {
    ray_ends.x += 1.;
    return texelFetch(picture_image, screen.texel, 0).rgb;
  }
  if (screen.end == SCREEN_SKY) {
    ray_ends.x += 1.;
    return sky_radiance(frame.sky, w, 0.);
  }
  if (screen.end == SCREEN_LEFT) ray_ends.y += 1.;
  if (screen.end == SCREEN_LOST) ray_ends.z += 1.;
  free = screen.free;
#if !VOXELS
  // What hides the way is the best guess of what it hides.
  if (screen.end == SCREEN_LOST && screen.texel.x >= 0) return texelFetch(picture_image, screen.texel, 0).rgb;
#endif
#endif
#if VOXELS
  // From where the picture knows no more. A free way of less than a cell says nothing of the voxels' own surfaces.
  bool own = free < grid.cascade[0].w;
  March ray = march(own ? x : x + free * w, w, own ? n : vec3(0), 1e30);
  return ray.radiance + ray.transmittance * sky_radiance(frame.sky, w, 0.);
#else
  return sky_radiance(frame.sky, w, 0.);
#endif
}
#endif
