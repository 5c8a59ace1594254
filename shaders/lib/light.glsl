// Light in a storage buffer: as many numbers as the light has channels (CHANNELS, 1 or 3). `vec3(l)` of a Light is its
// colour again, grey where it has one.
#ifndef LOOM_LIB_LIGHT_GLSL
#define LOOM_LIB_LIGHT_GLSL
#if CHANNELS == 1
#define Light float
float light_of(vec3 color) { return color.r; }
#else
#define Light vec3
vec3 light_of(vec3 color) { return color; }
#endif
#endif
