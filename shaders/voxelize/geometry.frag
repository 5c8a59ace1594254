// Geometry-shader clipping: the geometry stage has cut the triangle to this slice.
#include "voxelize/sampled.glsl"
flat in int slice;

void main() { add_sample(column_of_fragment(), slice); }
