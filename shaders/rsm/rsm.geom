// Sends each triangle to every light face that can see it.
#include "interop/light.h"
layout(triangles, invocations = INVOCATIONS) in;
layout(triangle_strip, max_vertices = 3) out;
// The same block twice: as input an array, as output one vertex.
#define SCENE_VARYING in
#define vertex vertex_in[]
#include "lib/scene_varyings.glsl"
#undef vertex
#undef SCENE_VARYING
#undef LOOM_LIB_SCENE_VARYINGS_GLSL
#define SCENE_VARYING out
#include "lib/scene_varyings.glsl"

layout(std430) readonly restrict buffer scratch_faces { LightFace faces[]; };
uniform int first_face;
uniform int face_count;

void main() {
  int layer = first_face + gl_InvocationID;
  if (layer >= face_count) return;
  mat4 to_clip = faces[layer].view_proj;
  vec4 clip[3];
  ivec4 outside = ivec4(1);  // all corners left, right, below, above
  bool nearer = true;
  for (int i = 0; i < 3; ++i) {
    clip[i] = to_clip * gl_in[i].gl_Position;
    outside *= ivec4(lessThan(clip[i].xy, -clip[i].ww), greaterThan(clip[i].xy, clip[i].ww));
    nearer = nearer && clip[i].z > clip[i].w;
  }
  if (outside != ivec4(0) || nearer) return;
  for (int i = 0; i < 3; ++i) {
    gl_Position = clip[i];
    gl_Layer = layer;
    gl_PrimitiveID = gl_PrimitiveIDIn;
    SCENE_COPY_VARYINGS(vertex, vertex_in[i]);
    EmitVertex();
  }
}
