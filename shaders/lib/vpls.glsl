// The virtual point lights of a VplSet input called `vpls`.
#ifndef LOOM_LIB_VPLS_GLSL
#define LOOM_LIB_VPLS_GLSL
#include "interop/vpl.h"
layout(std430) readonly restrict buffer vpls_lights {
  VplHeader vpl_header;
  Vpl vpls[];
};
layout(std140) uniform vpls_data { VplSet vpl_set; };
// Of rows of paths: light `vpl_first(LOOM_VPL_GROUPS)` is the end.
uint vpl_first(uint group) {
  return group < LOOM_VPL_GROUPS ? min(vpl_header.first[group >> 2u][group & 3u], uint(vpls.length()))
                                 : min(vpl_header.count.x, uint(vpls.length()));
}
uint vpl_count() { return min(vpl_header.count.x, uint(vpls.length())); }
#endif
