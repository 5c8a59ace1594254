// Injects one source: each element is a small Lambertian emitter of flux Φ, I(ω) += Φ/π·lobe(n), and a blocker. The
// emitter moves half a cell along its normal, so that a wall does not light itself.
#include "inject/inject.glsl"
#include "inject/elements.glsl"
#include "inject/source.glsl"
layout(local_size_x = 64) in;

#if FLUX
layout(std430) buffer scratch_fixed { int fixed_flux[]; };  // [channel][coefficient][cell]
layout(std430) readonly buffer scratch_scale { float flux_scale; };  // fixed-point units a W/sr
#endif
uniform int elements;

void main() {
  int index = element_index();
  Surfel surfel;
  if (index >= elements || !read_surfel(index, surfel)) return;
  if (surfel.area > 0.0) add_blocker(surfel.position, surfel.normal, surfel.area, surfel.albedo);
#if FLUX
  ivec3 cell;
  if (!grid_cell(grid, cascade, surfel.position + 0.5 * grid.cascade[cascade].w * surfel.normal, cell)) return;
  int k = grid_index(grid, cell), count = cell_count();
  vec4 lobe = sh2_cosine_lobe(surfel.normal) * (0.31830989 * flux_scale);
  for (int channel = 0; channel < CHANNELS; ++channel) {
    vec4 c = surfel.flux[channel] * lobe;
    for (int i = 0; i < 4; ++i) {
      int amount = int(round(c[i]));
      if (amount != 0) atomicAdd(fixed_flux[(4 * channel + i) * count + k], amount);  // two of four on an axis-aligned wall
    }
  }
#endif
}
