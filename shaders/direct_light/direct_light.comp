// E(x) = Σ I(ω)/r² ⟨n,l⟩₊ V
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/punctual_shadow.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
writeonly uniform image2D irradiance_irradiance;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 irradiance = vec3(0);
  if (depth > 0.) {
    vec3 x = surface_position(camera, pixel_uv(camera, pixel), depth);
    vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
    for (int i = 0; i < lights.length(); ++i) {
      vec3 l;
      vec3 arriving = light_irradiance(lights[i], x, l);
      float cosine = dot(n, l);
      if (cosine <= 0. || dot(n_g, l) <= 0. || arriving == vec3(0)) continue;
      irradiance += arriving * cosine * visibility(lights[i], x, n_g, depth);
    }
  }
  imageStore(irradiance_irradiance, pixel, vec4(irradiance, 1));
}
