// World space; the geometry stage projects once a light face.
#include "lib/scene_vertex.glsl"

void main() { gl_Position = vec4(scene_vertex(), 1); }
