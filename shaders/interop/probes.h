// A grid of probes that hold the radiance arriving at them. The bundle struct of ProbeField.
//
// Probe p = (x, y, z) stands at lower + p·spacing + its offset (member `state`: xyz metres, w: 1 on, 0 off). Member
// `coefficients` is an array of counts.z layers: texel (p.x·C + i, p.y) of layer p.z holds coefficient i of C as rgb.
// Member `moments` is one too: the R² texels from (p.x·R, p.y·R) of layer p.z are the octahedral map of probe p.
#ifndef LOOM_INTEROP_PROBES_H
#define LOOM_INTEROP_PROBES_H
#include "interop/interop.h"
LOOM_INTEROP_BEGIN
struct ProbeGrid {
  ivec4 counts;    // xyz: probes along each axis; w: coefficients of a probe, C
  vec4 lower;      // xyz: grid point of probe (0,0,0), world, metres
  vec4 spacing;    // xyz: metres; w: distances in `moments` are cut off here, metres
  vec4 weights;    // x: side of an octahedral map of moments, R; y: weight of a probe behind the surface
};
LOOM_STRUCT_SIZE(ProbeGrid, 64);
LOOM_INTEROP_END
#endif
