// Sends each triangle to the cube faces of a probe that can see it.
#include "radiance_field/texels.glsl"
layout(triangles, invocations = 6) in;
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
flat in int entry[];
flat out vec3 eye;  // where the probe stands, metres

layout(std430) readonly restrict buffer scratch_batch { int slots[]; };  // to capture
uniform int first_entry;
uniform int entry_count;
uniform float near;  // metres: nothing nearer is seen

void main() {
  if (entry[0] >= entry_count) return;
  vec3 at = standing_at(probe_of(slots[first_entry + entry[0]]));
  vec3 right, up, forward;
  cube_face(gl_InvocationID, right, up, forward);
  vec4 clip[3];
  ivec4 outside = ivec4(1);  // all corners left, right, below, above
  bool nearer = true;
  for (int i = 0; i < 3; ++i) {
    vec3 p = gl_in[i].gl_Position.xyz - at;
    clip[i] = vec4(dot(p, right), dot(p, up), near, dot(p, forward));
    outside *= ivec4(lessThan(clip[i].xy, -clip[i].ww), greaterThan(clip[i].xy, clip[i].ww));
    nearer = nearer && clip[i].z > clip[i].w;
  }
  if (outside != ivec4(0) || nearer) return;
  for (int i = 0; i < 3; ++i) {
    eye = at;
    gl_Position = clip[i];
    gl_Layer = 6 * entry[0] + gl_InvocationID;
    gl_PrimitiveID = gl_PrimitiveIDIn;
    SCENE_COPY_VARYINGS(vertex, vertex_in[i]);
    EmitVertex();
  }
}
