// Irradiance at the visible surface by N cones through the pyramid, E = π/N · Σ L. Their axes are a spiral of density
// cosθ/π about the normal, the same at every pixel; together they are as wide as the hemisphere, 2π/N each.
#include "interop/camera.h"
#include "interop/frame.h"
#include "lib/axes.glsl"
#include "lib/camera.glsl"
#include "lib/grid.glsl"
#include "lib/math.glsl"
#include "lib/sky.glsl"
#include "ray_march/pyramid.glsl"

layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
layout(std140) uniform voxels_data { Grid grid; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform sampler3D scratch_pyramid;
uniform int levels;
uniform int cones;

// The pyramid at a point (in cells of level 0), towards the direction `slab`, interpolated within the level; beyond the
// outermost cells there is nothing, and what they hold fades over one cell as between any two.
vec4 pyramid_at(vec3 at, int level, int slab) {
  vec3 cells = vec3(level_cells(grid.cells.xyz, level));
  vec3 q = at / float(1 << level), p = clamp(q, vec3(.5), cells - .5), near = max(1. - abs(q - p), vec3(0));
  return near.x * near.y * near.z *
         textureLod(scratch_pyramid,
                    (vec3(level_corner(grid.cells.xyz, level, slab)) + p) / vec3(textureSize(scratch_pyramid, 0)), 0.);
}

// Radiance along a cone from a surface; w: what of it is blocked. `aperture`: diameter over distance.
vec4 cone(vec3 origin, vec3 normal, vec3 direction, float aperture) {
  // A way of one cell's size along d crosses |d_x| + |d_y| + |d_z| faces, each with what its axis blocks.
  vec3 share = abs(direction);
  float rise = dot(direction, normal);
  ivec3 facing = ivec3(0, 2, 4) + ivec3(greaterThan(direction, vec3(0)));  // sides that look against the cone
  vec4 sum = vec4(0);
  float t = 1.;
  // No step is shorter than a cell: no more than there are cells along the three sides leave the grid.
  int most = grid.cells.x + grid.cells.y + grid.cells.z;
  for (int i = 0; i < most && sum.a < .99; ++i) {
    // As large as the cone is wide, and so small that interpolation, over one and a half cells, does not reach down to
    // the surface that the cone starts from: its back would block what never came from behind it.
    float clear = max(1., (1. + t * rise) / 1.5);  // a shading normal may lead below the surface
    int level = clamp(min(int(round(log2(aperture * t))), int(floor(log2(clear)))), 0, levels - 1);
    float size = float(1 << level);
    vec3 at = origin + normal + t * direction;
    if (any(lessThan(at, vec3(-size))) || any(greaterThan(at, vec3(grid.cells.xyz) + size))) break;
    vec4 met = share.x * pyramid_at(at, level, facing.x) + share.y * pyramid_at(at, level, facing.y) +
               share.z * pyramid_at(at, level, facing.z);
    // Interpolation spreads a wall over two steps, each of which sees a part of it: what they block adds up.
    sum += met * min(1., (1. - sum.a) / max(met.a, 1e-6));
    t += size;
  }
  return sum;
}

vec3 irradiance_at(ivec2 pixel) {
  vec3 x = surface_position(camera, pixel_uv(camera, pixel), texelFetch(surface_depth, pixel, 0).r);
  mat3 basis = orthonormal_basis(normalize(texelFetch(surface_normal, pixel, 0).xyz));
  vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  vec3 origin = grid_coordinates(grid, 0, x), irradiance = vec3(0);
  float cosine = 1. - 1. / float(cones);  // of the half-angle of a cone of 2π/N
  float aperture = 2. * sqrt(1. - cosine * cosine) / max(cosine, .1);
  for (int i = 0; i < cones; ++i) {
    float square = (float(i) + .5) / float(cones), angle = 2.3999632 * float(i);  // the golden angle
    vec3 local = vec3(sqrt(square) * vec2(cos(angle), sin(angle)), sqrt(1. - square));
    vec4 met = cone(origin, n_g, basis * local, aperture);
    irradiance += met.rgb;
#if EMITTER
    irradiance += max(0., 1. - met.a) * sky_radiance(frame.sky, basis * local, 2. * pi / float(cones));
#endif
  }
  return irradiance * (pi / float(cones));
}

#include "lib/resolution.glsl"
