// Finds probes inside geometry: what share of its sphere a probe sees as backs of faces, and the shortest way out, through
// the nearest of them and on to `margin` beyond.
#include "radiance_field/texels.glsl"
layout(local_size_x = 64) in;
layout(std430) writeonly restrict buffer scratch_found { vec4 found[]; };  // [slot] xyz: way out, metres; w: share of backs
uniform float margin;

void main() {
  int slot = int(gl_GlobalInvocationID.x);
  if (slot >= slot_count) return;
  float backs = 0., all = 0., nearest = 3.4e38;
  vec3 way = vec3(0);
  for (int t = 0; t < texel_count(); ++t) {
    int i = slot * texel_count() + t;
    float distance = -texels[i].distance;
    vec3 m = abs(texel_direction(t));
    float c = max(m.x, max(m.y, m.z)), solid_angle = c * c * c;  // up to a factor, by the texel's centre
    all += solid_angle;
    if (distance <= 0.) continue;
    backs += solid_angle;
    // The normal looks at the probe, so that the way out is against it.
    vec3 out_of = -unpack_surfel(surfaces[i]).n_g;
    float height = distance * dot(texel_direction(t), out_of);
    if (distance < nearest) {
      nearest = distance;
      way = out_of * (height + margin);
    }
  }
  found[slot] = vec4(way, backs / all);
}
