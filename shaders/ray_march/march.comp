// Irradiance at the visible surface: cosine-distributed rays through the voxels, E = π/N · Σ L.
#include "interop/camera.h"
#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/sampling.glsl"
#include "ray_march/exitant.glsl"
// After what sheets send out is known.
#include "lib/voxels.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
layout(rgba32f) uniform writeonly image2D irradiance_irradiance;
uniform int rays;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 sum = vec3(0);
  if (depth > 0.) {
    vec3 x = surface_position(camera, pixel_uv(camera, pixel), depth);
    vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
    uint seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x6d617263u);
    for (int k = 0; k < rays; ++k) {
      // The sub-pixel samples of one pixel continue one sequence.
      vec3 w = cosine_hemisphere(low_discrepancy(frame.random.z * uint(rays) + uint(k), seed), n);
      if (dot(w, n_g) <= 0.) continue;
      March ray = march(x, w, n_g, 1e30);
      sum += ray.radiance;
#if EMITTER
      sum += ray.transmittance * frame.sky.rgb;
#endif
    }
  }
  imageStore(irradiance_irradiance, pixel, vec4(sum * (pi / float(rays)), 1));
}
