// One step of light propagation: each cell gathers, from its six neighbours, the flux through its own five far faces,
// and sends it on as a cosine lobe about each face's normal: Φ_face = I(ω)·Δω, coefficients Φ_face/π·lobe(n).
// A face between two cells lets 1−B through; B·ρ of what arrives is reflected into the next order.
#include "lpv/cells.glsl"
layout(local_size_x = 32, local_size_y = 1, local_size_z = 1) in;

#if BLOCKERS
uniform sampler3D blockers_occupancy;  // of each cell's three lower faces
uniform sampler3D blockers_albedo;     // slices [0,n): x faces, [n,2n): y, [2n,3n): z
#endif
uniform int source_half;

const float INV_PI = 0.31830989;

#if BLOCKERS
// The blocker of the face that light crosses going from `from` to its neighbour in direction i.
float blocker(ivec3 from, int i, out vec3 albedo) {
  int axis = i >> 1;
  ivec3 owner = from;
  if ((i & 1) == 0) owner[axis] += 1;
  albedo = vec3(0);
  if (owner[axis] >= grid.cells[axis]) return 0.0;
  albedo = texelFetch(blockers_albedo, owner + ivec3(0, 0, axis * grid.cells.z), 0).rgb;
  return texelFetch(blockers_occupancy, owner, 0)[axis];
}
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  int n = cell_count(), self = grid_index(grid, cell);
  int from_base = source_half * 4 * n, to_base = (1 - source_half) * 4 * n;
  vec4 arrived[3] = vec4[3](vec4(0), vec4(0), vec4(0));
#if BLOCKERS
  vec4 reflected[3] = vec4[3](vec4(0), vec4(0), vec4(0));
#endif

  for (int i = 0; i < 6; ++i) {
    vec3 d = axis_direction(i);
    // What comes in from the neighbour behind.
    ivec3 neighbour = cell - ivec3(d);
    if (all(greaterThanEqual(neighbour, ivec3(0))) && all(lessThan(neighbour, grid.cells.xyz))) {
      int k = from_base + grid_index(grid, neighbour);
      vec4 factors = front[k + 3 * n];
      float open = 1.0;
#if BLOCKERS
      vec3 unused;
      open -= blocker(neighbour, i, unused);
#endif
      for (int channel = 0; channel < 3; ++channel) {
        vec4 c = front[k + channel * n];
        for (int j = 0; j < 6; ++j) {
          vec3 f = axis_direction(j);
          if (dot(d, f) < -0.5) continue;
          float flux = max(0.0, dot(c, sh2_basis(to_face(d, f)))) * face_solid_angle(d, f);
          arrived[channel] += (open * factors[channel] * flux * INV_PI) * sh2_cosine_lobe(f);
        }
      }
    }
#if BLOCKERS
    // What this cell sends out in direction d and a surface on that face throws back.
    vec3 albedo;
    float wall = blocker(cell, i, albedo);
    if (wall > 0.0) {
      int k = from_base + self;
      vec4 factors = front[k + 3 * n];
      for (int channel = 0; channel < 3; ++channel) {
        vec4 c = front[k + channel * n];
        float flux = 0.0;
        for (int j = 0; j < 6; ++j) {
          vec3 f = axis_direction(j);
          if (dot(d, f) < -0.5) continue;
          flux += max(0.0, dot(c, sh2_basis(to_face(d, f)))) * face_solid_angle(d, f);
        }
        reflected[channel] += (wall * albedo[channel] * factors[channel] * flux * INV_PI) * sh2_cosine_lobe(-d);
      }
    }
#endif
  }

  vec4 next_factors = vec4(0);
  for (int channel = 0; channel < 3; ++channel) {
    front[to_base + channel * n + self] = arrived[channel];
    next_factors[channel] = flux_keeping_factor(arrived[channel]);
    sum[channel * n + self] += arrived[channel];
#if BLOCKERS
    blocked[channel * n + self] += reflected[channel];
#endif
  }
  front[to_base + 3 * n + self] = next_factors;
}
