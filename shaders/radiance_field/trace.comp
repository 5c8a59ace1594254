// Captures by one ray a texel, through its centre, instead of by drawing: the cost falls with the logarithm of the number
// of triangles. A ray samples no texture: albedo is the mean over the material's, and normals are the triangles'.
#include "lib/trace.glsl"
#include "radiance_field/texels.glsl"
layout(local_size_x = 64) in;
layout(std430) readonly restrict buffer scratch_batch { int slots[]; };  // to capture
uniform int entry_count;

void main() {
  int t = int(gl_GlobalInvocationID.x), entry = int(gl_GlobalInvocationID.y);
  if (t >= texel_count() || entry >= entry_count) return;
  int slot = slots[entry];
  if (slot < 0 || slot >= slot_count) return;
  vec3 ray = texel_direction(t), n = vec3(0, 1, 0), albedo = vec3(0);
  Hit hit = closest_hit(standing_at(probe_of(slot)), ray, no_hit);
  float distance = 0.;
  if (is_hit(hit)) {
    n = hit_normal(hit);
    albedo = hit_albedo(hit);
    distance = hit.t;
    if (dot(n, ray) > 0.) {
      n = -n;
      if ((materials[hit_material(hit)].flags.x & MATERIAL_DOUBLE_SIDED) == 0u) distance = -distance;
    }
  }
  int i = slot * texel_count() + t;
  texels[i] = Texel(Light(0), distance);
  surfaces[i] = pack_surfel(Surfel(n, n, albedo));
}
