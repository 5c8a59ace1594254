// The samples of a pixel, shared out over several dispatches where one could not finish them (loom/rounds.h). Each is the
// mean over as many samples of one sequence; lib/resolution.glsl takes the mean of them.
#ifndef LOOM_LIB_PARTS_GLSL
#define LOOM_LIB_PARTS_GLSL
#if PARTS
uniform ivec2 part;  // which, of how many
#else
const ivec2 part = ivec2(0, 1);
#endif

// Of `samples`, how many a part takes.
int samples_of_part(int samples) { return (samples + part.y - 1) / part.y; }

// The sub-pixel samples of one pixel continue one sequence, and so do their parts: of those of `sample_index`, which
// stretch is this part's.
uint stretch_of_part(uint sample_index) { return sample_index * uint(part.y) + uint(part.x); }
#endif
