// Light paths backwards: from a point of the lattice by reflections, density cosθ/π, to where they leave the scene.
#include "lib/trace.glsl"
#include "prt/lattice.glsl"
#include "prt/paths.glsl"
layout(local_size_x = 64) in;
layout(std430) writeonly restrict buffer scratch_paths { PathEnd ends[]; };
uniform int reflections;

void main() {
  int path = int(gl_GlobalInvocationID.x), slot = int(gl_GlobalInvocationID.y), point = first_point + slot;
  if (path >= paths || slot >= batch_size || point >= point_count() || slot * paths + path >= ends.length()) return;
  vec3 origin = point_position(point), w = path_direction(point, path), weight = vec3(1);
  PathEnd end = PathEnd(vec4(w, 0), vec4(0));
  for (int k = 0; k <= reflections; ++k) {
    Hit hit = closest_hit(origin, w, no_hit);
    if (!is_hit(hit)) {
      end.exit.xyz = w;
      end.weight = vec4(weight, k);
      break;
    }
    vec3 n = hit_normal(hit);
    bool back = dot(n, w) > 0.;
    if (back) n = -n;
    if (k == 0) {
      bool inside = back && (materials[hit_material(hit)].flags.x & MATERIAL_DOUBLE_SIDED) == 0u;
      end.exit.w = inside ? -hit.t : hit.t;
    }
    weight *= hit_albedo(hit);
    if (weight == vec3(0)) break;
    origin = offset_origin(hit_position(hit), n, hit.t);
    uint seed = hash(uvec4(point, 0x707274u, k + 1, 0u)).x;
    w = cosine_hemisphere(low_discrepancy(uint(path), seed), n);
  }
  ends[slot * paths + path] = end;
}
