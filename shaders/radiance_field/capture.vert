// World space; the geometry stage projects once a cube face. Copy i of a triangle is for entry i of the batch.
#include "lib/scene_vertex.glsl"
flat out int entry;

void main() {
  entry = gl_InstanceID;
  gl_Position = vec4(scene_vertex(), 1);
}
