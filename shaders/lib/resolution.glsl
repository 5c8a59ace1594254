// main() of a pass that finds irradiance pixel by pixel, at full size or at a part of it (loom/resolution.h). The including
// file declares `camera` and the samplers surface_depth and surface_normal, and defines
//   vec3 irradiance_at(ivec2 pixel)   for a pixel at which a surface is seen.
// The class Resolution compiles it as
//   RESOLUTION_FULL    every pixel;
//   RESOLUTION_COARSE  one pixel of each block of `resolution`² pixels;
//   RESOLUTION_FINE    every pixel, from the four nearest of those, weighted bilinearly and by what tells surfaces apart,
//     w = bilinear · ⟨n_p,n_q⟩₊⁶⁴ · exp(−½(d/f)²),
//   d the distance of either point from the plane of the other, f the width of the pixel there (as Denoise has it, with
//   shading normals). A pixel that finds less than `least_weight` of 1 lies on a surface of its own: it is computed.
//   The weights do not look at the light: what is constant stays so, to the bit.
// Joint bilateral upsampling: Kopf et al., SIGGRAPH 2007.
#include "lib/edge.glsl"
#include "lib/parts.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
#if RESOLUTION == RESOLUTION_COARSE
writeonly uniform image2D scratch_coarse;
#else
writeonly uniform image2D irradiance_irradiance;
#endif
#if RESOLUTION == RESOLUTION_FINE
uniform sampler2D scratch_coarse;
#endif
#if PARTS
layout(rgba32f) uniform image2D scratch_sum;
#endif
uniform int resolution;

float seen_depth(ivec2 pixel) { return texelFetch(surface_depth, pixel, 0).r; }

// The pixel that stands for a block: its middle, or the one beyond it.
ivec2 block_pixel(ivec2 block) {
  return min(resolution * block + resolution / 2, textureSize(surface_depth, 0) - 1);
}

#if RESOLUTION == RESOLUTION_FINE
const float least_weight = .05;

struct Guide {
  vec3 offset;  // position less the eye
  vec3 normal;
  float footprint;
};

Guide guide_at(ivec2 pixel, float depth) {
  vec2 uv = pixel_uv(camera, pixel);
  Guide guide;
  guide.offset = ray_origin(camera, uv) - camera.eye.xyz + depth * ray_direction(camera, uv);
  guide.normal = normalize_or(texelFetch(surface_normal, pixel, 0).xyz, vec3(0));
  guide.footprint = pixel_footprint(camera, uv, depth);
  return guide;
}

// Irradiance from the coarse pixels around; false where none shows this surface.
bool upsampled(ivec2 pixel, float depth, out vec3 irradiance) {
  Guide p = guide_at(pixel, depth);
  vec2 at = (vec2(pixel) - float(resolution / 2)) / float(resolution);
  ivec2 corner = ivec2(floor(at)), last = textureSize(scratch_coarse, 0) - 1;
  vec2 f = at - vec2(corner);
  float weights = 0.;
  vec3 first = vec3(0), difference = vec3(0);  // Σ w·(E(q) − E(first)): nothing where E is constant
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1), block = clamp(corner + step, ivec2(0), last), tap = block_pixel(block);
    vec2 linear = mix(1. - f, f, vec2(step));
    float tap_depth = seen_depth(tap), weight = linear.x * linear.y;
    vec3 value = texelFetch(scratch_coarse, block, 0).rgb;
    if (!(tap_depth > 0.) || weight <= 0.) continue;
    Guide q = guide_at(tap, tap_depth);
    float d = mutual_plane_distance(q.offset - p.offset, p.normal, q.normal) / min(p.footprint, q.footprint);
    weight *= pow(clamp(dot(p.normal, q.normal), 0., 1.), 64.) * exp(-.5 * d * d);
    if (weight <= 0.) continue;
    if (weights == 0.) first = value;
    weights += weight;
    difference += weight * (value - first);
  }
  irradiance = weights > 0. ? max(vec3(0), first + difference / weights) : vec3(0);
  return weights >= least_weight;
}
#endif

// The mean over the parts up to this one, times their share; false before the last. `at`: where in the image of sums.
bool add_part(ivec2 at, inout vec3 irradiance) {
#if PARTS
  irradiance /= float(part.y);
  if (part.x > 0) irradiance += imageLoad(scratch_sum, at).rgb;
  if (part.x + 1 < part.y) {
    imageStore(scratch_sum, at, vec4(irradiance, 0));
    return false;
  }
#endif
  return true;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  vec3 irradiance = vec3(0);
#if RESOLUTION == RESOLUTION_COARSE
  ivec2 block = pixel;
  if (any(greaterThanEqual(block, imageSize(scratch_coarse)))) return;
  pixel = block_pixel(block);
  if (seen_depth(pixel) > 0.) irradiance = irradiance_at(pixel);
  if (!add_part(block, irradiance)) return;
  imageStore(scratch_coarse, block, vec4(irradiance, 1));
#else
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = seen_depth(pixel);
  bool found = !(depth > 0.);
#if RESOLUTION == RESOLUTION_FINE
  if (!found) found = upsampled(pixel, depth, irradiance);
#endif
  if (!found) {
    irradiance = irradiance_at(pixel);
    if (!add_part(pixel, irradiance)) return;
  }
  imageStore(irradiance_irradiance, pixel, vec4(irradiance, 1));
#endif
}
