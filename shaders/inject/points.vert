// The lecture's path: each element is a point, sent to the layer of the volume that holds its cell.
#include "inject/inject.glsl"
#include "inject/source.glsl"

uniform int elements;
flat out int layer;  // −1: outside the grid
flat out vec3 normal;
flat out vec3 flux;

void main() {
  layer = -1;
  normal = flux = vec3(0);
  gl_Position = vec4(0, 0, 0, 1);
  Surfel surfel;
  if (gl_VertexID >= elements || !read_surfel(gl_VertexID, surfel)) return;
  ivec3 cell;
  if (!grid_cell(grid, cascade, surfel.position + 0.5 * grid.cascade[cascade].w * surfel.normal, cell)) return;
  layer = volume_texel(cell).z;
  normal = surfel.normal;
  flux = surfel.flux;
  gl_Position = vec4((2.0 * vec2(cell.xy) + 1.0) / vec2(grid.cells.xy) - 1.0, 0.5, 1.0);
}
