// What a light sees in the direction of each texel of its map: unit normal towards the light and distance, or 0. A map
// that holds (`todo` 1) stays as it is.
#include "lib/octahedral.glsl"
#include "lib/trace.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
struct Owner {
  vec4 position;
  vec4 normal;
};
layout(std430) readonly restrict buffer persistent_owners { Owner owners[]; };
layout(std430) readonly restrict buffer scratch_todo { uint todo[]; };
layout(rgba32f) writeonly uniform image2DArray shadows_maps;

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  ivec3 size = imageSize(shadows_maps);
  if (any(greaterThanEqual(texel, size)) || texel.z >= todo.length() || todo[texel.z] == 1u) return;
  if (todo[texel.z] == 0u) {  // no light has this map
    imageStore(shadows_maps, texel, vec4(0));
    return;
  }
  vec3 n = owners[texel.z].normal.xyz;
  vec2 p = (2. * vec2(texel.xy) + 1.) / vec2(size.xy) - 1.;
  vec3 direction = orthonormal_basis(n) * hemisphere_decode(p);
  Hit hit = closest_hit(offset_origin(owners[texel.z].position.xyz, n, 0.), direction, no_hit);
  vec4 seen = vec4(0);
  if (is_hit(hit)) {
    vec3 normal = hit_normal(hit);
    seen = vec4(dot(normal, direction) > 0. ? -normal : normal, hit.t);
  }
  imageStore(shadows_maps, texel, seen);
}
