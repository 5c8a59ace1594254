// Volumes by side of a sheet hold a colour, or its luminance alone.
#ifndef LOOM_VOXELIZE_CHANNELS_GLSL
#define LOOM_VOXELIZE_CHANNELS_GLSL
#include "lib/math.glsl"
#include "lib/storage.glsl"
#if GREY
#define ALBEDO_FORMAT rg16f
#define LIGHT_FORMAT STORAGE_R
#else
#define ALBEDO_FORMAT rgba16f
#define LIGHT_FORMAT STORAGE_RGBA
#endif

vec4 in_channels(vec3 colour, float last) {
#if GREY && LUMINANCE
  return vec4(luminance(colour), last, 0, 0);
#elif GREY
  return vec4(colour.r, last, 0, 0);  // the channels are equal
#else
  return vec4(colour, last);
#endif
}

vec3 from_channels(vec4 texel) {
#if GREY
  return texel.rrr;
#else
  return texel.rgb;
#endif
}
#endif
