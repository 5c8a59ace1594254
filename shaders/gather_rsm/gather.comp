// The light that the virtual lights give.
#define CLAMPED 0
#define MISSED 0
#include "gather_rsm/gather.glsl"

vec3 irradiance_at(ivec2 pixel) { return gathered_at(pixel).given; }

#include "lib/resolution.glsl"
