// Radiance of the sky by direction: constant, or an equirectangular image (framework/scene/sky.h says which way it lies).
// The including file defines SCENE_SKY_IMAGE where it is an image (scene_defines).
#ifndef LOOM_LIB_SKY_GLSL
#define LOOM_LIB_SKY_GLSL
#include "lib/math.glsl"
#ifndef SCENE_SKY_IMAGE
#define SCENE_SKY_IMAGE 0
#endif
#if SCENE_SKY_IMAGE
uniform sampler2D scene_sky;
#endif

// `sky`: FrameData.sky. The mean over about `solid_angle` around the unit vector w, what one of several rays or cones
// stands for; 0: from w alone. A level of the image that is read with a linear filter averages over a tent, whose variance
// along an axis is δ²/4 with texels of δ (δ²/12 of the texel, δ²/6 of the tent), as much as that of a cap of the solid
// angle πδ²: its radius² over 4.
vec3 sky_radiance(vec4 sky, vec3 w, float solid_angle) {
#if SCENE_SKY_IMAGE
  vec2 size = vec2(textureSize(scene_sky, 0));
  float texel = 2. * pi * pi / (size.x * size.y);  // at the horizon, sr
  float level = .5 * log2(max(solid_angle / (pi * texel), 1.));
  // The texture repeats: at the poles it would reach over to the other one.
  float edge = .5 * exp2(ceil(level)) / size.y;
  vec2 at = vec2(.5 + sky.w + (w.x == 0. && w.z == 0. ? 0. : atan(w.x, -w.z)) / (2. * pi),
                 clamp(acos(clamp(w.y, -1., 1.)) / pi, min(edge, .5), max(1. - edge, .5)));
  return textureLod(scene_sky, at, level).rgb;
#else
  return sky.rgb;
#endif
}
#endif
