// The lights that there are, without gaps, in the order of their paths: the same set on every run. One work group; each
// thread takes a row of paths.
#include "interop/vpl.h"
#define THREADS LOOM_VPL_GROUPS
layout(local_size_x = THREADS) in;
layout(std430) readonly restrict buffer persistent_slots { Vpl slots[]; };
layout(std430) restrict buffer vpls_lights {
  VplHeader header;
  Vpl lights[];
};
uniform int order_count;
#if COUNTS
writeonly uniform image2D counts_image;
#endif

// Lights, kept, paths.
shared uvec3 found[THREADS];
shared float power[THREADS];

void main() {
  int thread = int(gl_LocalInvocationIndex);
  int paths = slots.length() / max(order_count, 1);
  int first = thread * paths / THREADS * order_count, end = (thread + 1) * paths / THREADS * order_count;
  uvec3 here = uvec3(0);
  float watts = 0.;
  for (int i = first; i < end; ++i) {
    vec4 flux = slots[i].flux;
    float order = slots[i].position.w;
    if (order == 0.) continue;
    here += uvec3(1u, uint(flux.w), order == 1. ? 1u : 0u);
    watts += (flux.r + flux.g + flux.b) / 3.;
  }
  found[thread] = here;
  power[thread] = watts;
  barrier();
  uint to = 0u;
  for (int i = 0; i < thread; ++i) to += found[i].x;
  header.first[thread >> 2][thread & 3] = to;
  for (int i = first; i < end; ++i) {
    if (slots[i].position.w == 0. || to >= uint(lights.length())) continue;
    lights[to++] = slots[i];
  }
  if (thread > 0) return;
  uvec3 all = uvec3(0);
  float sum = 0.;
  for (int i = 0; i < THREADS; ++i) {
    all += found[i];
    sum += power[i];
  }
  header.count = uvec4(all, 0u);
#if COUNTS
  imageStore(counts_image, ivec2(0), vec4(vec3(all), sum));
#endif
}
