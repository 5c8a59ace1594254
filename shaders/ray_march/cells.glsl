// Which cells of the volume send rays: those that a pixel reads.
#ifndef LOOM_RAY_MARCH_CELLS_GLSL
#define LOOM_RAY_MARCH_CELLS_GLSL
layout(r32ui) uniform uimage3D persistent_cells;
const uint asleep = 0u, awake = 1u, marched = 2u;
#endif
