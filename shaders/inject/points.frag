// I(ω) += Φ/π·lobe(n), added up by blending.
#include "lib/sh.glsl"
flat in vec3 point_normal;
flat in vec3 point_flux;
layout(location = 0) out vec4 out_red;
#if CHANNELS > 1
layout(location = 1) out vec4 out_green;
layout(location = 2) out vec4 out_blue;
#endif

void main() {
  vec4 lobe = 0.31830989 * sh2_cosine_lobe(point_normal);
  out_red = point_flux.r * lobe;
#if CHANNELS > 1
  out_green = point_flux.g * lobe;
  out_blue = point_flux.b * lobe;
#endif
}
