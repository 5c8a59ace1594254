// Starts one order: order 1 from the injected flux, every further one from what surfaces reflected.
#include "lpv/cells.glsl"
layout(local_size_x = 64) in;

uniform sampler3D flux_red;
uniform sampler3D flux_green;
uniform sampler3D flux_blue;
uniform int order;

void main() {
  int n = cell_count(), i = int(gl_GlobalInvocationID.x);
  if (i >= n) return;
  ivec3 cell = ivec3(i % grid.cells.x, (i / grid.cells.x) % grid.cells.y, i / (grid.cells.x * grid.cells.y));
  vec4 c[3];
  if (order == 0) {
    c = vec4[3](texelFetch(flux_red, cell, 0), texelFetch(flux_green, cell, 0), texelFetch(flux_blue, cell, 0));
  } else {
    c = vec4[3](blocked[i], blocked[n + i], blocked[2 * n + i]);
  }
  vec4 factors = vec4(0);
  for (int channel = 0; channel < 3; ++channel) {
    front[channel * n + i] = c[channel];
    factors[channel] = flux_keeping_factor(c[channel]);
    sum[channel * n + i] = (order == 0 ? vec4(0) : sum[channel * n + i]) + c[channel];
    blocked[channel * n + i] = vec4(0);
  }
  front[3 * n + i] = factors;
}
