// World space; the geometry stage projects along the triangle's dominant axis.
#include "lib/scene_vertex.glsl"

void main() { gl_Position = vec4(scene_vertex(), 1); }
