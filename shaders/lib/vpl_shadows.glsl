// The maps of a VplShadows input called `shadows`: which share of a virtual light's flux arrives at a point.
//
// A texel holds a point y of the surface that the light sees in the direction of its middle, and the normal there. It
// hides x where y lies on the light's side of the plane of x, and x behind the plane of y. Both hold for what lies
// between, neither for the surface of x itself, plane, bulging or hollow: so there is no bias, and no acne. The four
// texels around are weighted bilinearly (Reeves et al., "Rendering Antialiased Shadows with Depth Maps", 1987).
#ifndef LOOM_LIB_VPL_SHADOWS_GLSL
#define LOOM_LIB_VPL_SHADOWS_GLSL
#include "interop/vpl.h"
#include "lib/octahedral.glsl"
#include "lib/trace.glsl"
layout(std140) uniform shadows_data { VplShadows vpl_shadows; };
uniform sampler2DArray shadows_maps;
layout(std430) readonly restrict buffer shadows_of { uint vpl_map_of[]; };

// Half-float normals tell no more of the two sides of a plane, per metre along it.
const float plane_error = 9.765625e-4;  // 2⁻¹⁰

// `map`: 1 + layer. x: position; n: its unit geometric normal on the light's side; extent: as in offset_origin().
float mapped_visibility(uint map, Vpl light, vec3 x, vec3 n, float extent) {
  int size = vpl_shadows.count.x;
  mat3 basis = orthonormal_basis(light.normal.xyz);
  vec3 d = x - light.position.xyz, m = abs(x);
  float rounding = 2. * position_error * (max(m.x, max(m.y, m.z)) + extent);
  vec2 at = .5 * float(size) * (hemisphere_encode(d * basis) + 1.) - .5, f = fract(at);
  ivec2 corner = ivec2(floor(at));
  float visible = 0.;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1), texel = clamp(corner + step, ivec2(0), ivec2(size - 1));
    vec2 weight = mix(1. - f, f, vec2(step));
    vec4 seen = texelFetch(shadows_maps, ivec3(texel, int(map) - 1), 0);
    vec3 w = basis * hemisphere_decode((2. * vec2(texel) + 1.) / float(size) - 1.);
    vec3 from_seen = d - seen.w * w;
    bool hides = seen.w > 0. && -dot(n, from_seen) > rounding + plane_error * length(from_seen) &&
                 dot(seen.xyz, from_seen) < -rounding;
    visible += hides ? 0. : weight.x * weight.y;
  }
  return visible;
}
#endif
