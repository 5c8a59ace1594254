// Takes the layers of one raster batch into the texels of its probes.
#include "radiance_field/texels.glsl"
layout(local_size_x = 64) in;
layout(std430) readonly restrict buffer scratch_batch { int slots[]; };
uniform sampler2DArray scratch_normals;
uniform sampler2DArray scratch_surface;
uniform int first_entry;
uniform int entry_count;

void main() {
  int t = int(gl_GlobalInvocationID.x), entry = int(gl_GlobalInvocationID.y);
  if (t >= texel_count() || entry >= entry_count) return;
  int slot = slots[first_entry + entry];
  if (slot < 0 || slot >= slot_count) return;
  ivec3 at = ivec3(t % face_size, (t / face_size) % face_size, 6 * entry + t / (face_size * face_size));
  vec4 normals = texelFetch(scratch_normals, at, 0), surface = texelFetch(scratch_surface, at, 0);
  int i = slot * texel_count() + t;
  texels[i] = Texel(Light(0), surface.a);
  surfaces[i] = pack_surfel(Surfel(octahedral_decode(normals.xy), octahedral_decode(normals.zw), surface.rgb));
}
