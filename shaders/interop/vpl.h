// Virtual point lights. Member `lights` of VplSet is a storage block: VplHeader, then the lights, those of one path one
// after the other, paths in order.
#ifndef LOOM_INTEROP_VPL_H
#define LOOM_INTEROP_VPL_H
#include "interop/interop.h"
LOOM_INTEROP_BEGIN
// A point of a surface that reflects the flux Φ: radiant intensity Φ/π·cosθ on the side of its normal.
struct Vpl {
  vec4 position;   // xyz: world, metres; w: order, reflections since the light was emitted (1, 2, …)
  vec4 normal;     // xyz: unit, geometric, on the side that reflects; w: index of the path
  vec4 flux;       // rgb: Φ, W; w: 1 where the last frame had the same light in the same place
};
LOOM_STRUCT_SIZE(Vpl, 48);
// The paths in LOOM_VPL_GROUPS equal rows: component g & 3 of first[g >> 2] is the first light of row g.
#define LOOM_VPL_GROUPS 256
struct VplHeader {
  uvec4 count;     // x: lights; y: those that the last frame had in the same place; z: paths that reached a surface
  uvec4 first[LOOM_VPL_GROUPS / 4];
};
LOOM_STRUCT_SIZE(VplHeader, 1040);
// The bundle struct of VplSet.
struct VplSet {
  ivec4 count;     // x: paths; y: most lights of a path
};
LOOM_STRUCT_SIZE(VplSet, 16);
// The bundle struct of VplShadows.
struct VplShadows {
  ivec4 count;     // x: side of a map, texels; y: maps
};
LOOM_STRUCT_SIZE(VplShadows, 16);
LOOM_INTEROP_END
#endif
