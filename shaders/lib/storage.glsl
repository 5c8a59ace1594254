// Light in the numbers that a volume is stored in. HALF = 1: half floats, half the memory, 11 bits.
#ifndef LOOM_LIB_STORAGE_GLSL
#define LOOM_LIB_STORAGE_GLSL
#if HALF
#define STORAGE_RGBA rgba16f
#define STORAGE_R r16f
// The bound is the largest finite half: more becomes infinite when it is stored, and 0·∞ is NaN, which spreads from cell
// to cell.
vec4 stored(vec4 value) { return clamp(value, vec4(-65504), vec4(65504)); }
#else
#define STORAGE_RGBA rgba32f
#define STORAGE_R r32f
vec4 stored(vec4 value) { return value; }
#endif
#endif
