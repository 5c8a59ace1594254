// Paths from the points of a batch: what project.comp reads of them.
#include "lib/sampling.glsl"
struct PathEnd {
  vec4 exit;    // xyz: unit, where it leaves the scene; w: distance to the first surface, negative on the back of a
                // single-sided one, 0 where there is none
  vec4 weight;  // rgb: product of the albedos on the way, 0 where it does not leave; w: reflections
};
uniform int paths;        // of a point
uniform int first_point;  // of the batch
uniform int batch_size;

vec3 path_direction(int point, int path) {
  return uniform_sphere(low_discrepancy(uint(path), hash(uvec4(point, 0x707274u, 0u, 0u)).x));
}
