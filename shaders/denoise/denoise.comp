// E'(p) = Σ w·E(q) / Σ w over 5×5 pixels `stride` apart, w = h·⟨n_p,n_q⟩₊^k·exp(−½(d/(σf))²).
#include "lib/edge.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
#if FIRST
uniform sampler2D noisy_irradiance;
#endif
#if !FIRST || !LAST
layout(rgba32f) uniform image2DArray scratch_levels;
#endif
#if LAST
writeonly uniform image2D irradiance_irradiance;
#endif
uniform int stride;
uniform int target;  // layer of scratch_levels that is written; the other one is read
uniform float plane_sigma;
uniform float normal_exponent;

vec3 source(ivec2 pixel) {
#if FIRST
  return texelFetch(noisy_irradiance, pixel, 0).rgb;
#else
  return imageLoad(scratch_levels, ivec3(pixel, 1 - target)).rgb;
#endif
}

void store(ivec2 pixel, vec3 irradiance) {
#if LAST
  imageStore(irradiance_irradiance, pixel, vec4(irradiance, 1));
#else
  imageStore(scratch_levels, ivec3(pixel, target), vec4(irradiance, 1));
#endif
}

struct Point {
  vec3 offset;  // world position less the eye
  vec3 normal;  // shading
  vec3 plane;   // normal of the triangle
  float footprint;
};

Point point_at(ivec2 pixel, float depth) {
  vec2 uv = pixel_uv(camera, pixel);
  Point point;
  point.footprint = pixel_footprint(camera, uv, depth);
  point.offset = ray_origin(camera, uv) - camera.eye.xyz + depth * ray_direction(camera, uv);
  point.normal = normalize_or(texelFetch(surface_normal, pixel, 0).xyz, vec3(0));
  point.plane = normalize_or(texelFetch(surface_geometric_normal, pixel, 0).xyz, vec3(0));
  return point;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(surface_depth, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  if (!(depth > 0.)) {
    store(pixel, vec3(0));
    return;
  }
  Point p = point_at(pixel, depth);
  vec3 centre = source(pixel);
  bool seeded = is_finite(centre);
  if (!seeded) centre = vec3(0);

  const float spline[3] = float[3](.375, .25, .0625);
  float weights = seeded ? spline[0] * spline[0] : 0.;
  vec3 difference = vec3(0);  // Σ w·(E(q) − E(p)): nothing where E is constant
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      ivec2 tap = pixel + stride * ivec2(x, y);
      if ((x == 0 && y == 0) || any(lessThan(tap, ivec2(0))) || any(greaterThanEqual(tap, size))) continue;
      float tap_depth = texelFetch(surface_depth, tap, 0).r;
      vec3 value = source(tap);
      if (!(tap_depth > 0.) || !is_finite(value)) continue;
      Point q = point_at(tap, tap_depth);
      float cosine = clamp(dot(p.normal, q.normal), 0., 1.);
      float d = mutual_plane_distance(q.offset - p.offset, p.plane, q.plane);
      d /= plane_sigma * min(p.footprint, q.footprint);
      float weight = spline[abs(x)] * spline[abs(y)] * exp(-.5 * d * d);
      // pow(0, 0) is undefined: with k = 0 the normals do not count.
      if (normal_exponent > 0.) weight *= pow(cosine, normal_exponent);
      weights += weight;
      difference += weight * (value - centre);
    }
  }
  store(pixel, max(vec3(0), weights > 0. ? centre + difference / weights : centre));
}
