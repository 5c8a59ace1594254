// Injects one light's texels: each is a small Lambertian emitter of flux Φ, I(ω) += Φ/π·lobe(n), and a blocker of area
// A = r²·ω_texel/<n,−l>. The emitter moves half a cell along its normal, so that a wall does not light itself.
#include "inject/inject.glsl"
#include "lib/rsm.glsl"
#include "lib/sh.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std430) readonly buffer lights_faces { LightFace faces[]; };
layout(std430) readonly buffer scene_lights { Light scene_light[]; };
uniform sampler2DArray lights_flux;
uniform sampler2DArray lights_normal;
uniform sampler2DArray lights_depth;
layout(std430) buffer scratch_fixed { int fixed_flux[]; };  // [channel][coefficient][cell]

uniform int first_face;
uniform float flux_scale;  // fixed-point units a W/sr, derived from this light's own power
uniform float area_scale;

void main() {
  ivec2 size = textureSize(lights_flux, 0).xy;
  if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), size))) return;
  ivec3 texel = ivec3(gl_GlobalInvocationID.xy, first_face + int(gl_GlobalInvocationID.z));
  float depth = texelFetch(lights_depth, texel, 0).r;
  if (!(depth > 0.0)) return;

  LightFace face = faces[texel.z];
  Light light = scene_light[int(face.origin.w)];
  vec3 n = normalize(texelFetch(lights_normal, texel, 0).xyz);
  vec3 flux = texelFetch(lights_flux, texel, 0).rgb;
  vec2 q = texel_plane(texel.xy, size.x);
  vec3 position = face_position(face, q, depth);
  vec3 direction = is_directional(face) ? face.forward.xyz : normalize(face_ray(face, q));
  float measure = texel_measure(face, q, size.x);  // solid angle; directional: area
  vec3 received = light_intensity(light, direction) * measure;  // flux that arrives in the texel
  float facing_area = is_directional(face) ? measure : depth * depth * measure;

  vec3 albedo = vec3(0);
  for (int channel = 0; channel < 3; ++channel) {
    if (received[channel] > 0.0) albedo[channel] = flux[channel] / received[channel];
  }
  float cosine = dot(n, -direction);
  if (cosine > 0.0) add_blocker(position, n, facing_area / cosine, albedo, area_scale);

  ivec3 cell;
  if (!grid_cell(grid, 0, position + 0.5 * grid.cascade[0].w * n, cell)) return;
  int k = grid_index(grid, cell), count = cell_count();
  vec4 lobe = sh2_cosine_lobe(n) * (0.31830989 * flux_scale);
  for (int channel = 0; channel < 3; ++channel) {
    vec4 c = flux[channel] * lobe;
    for (int i = 0; i < 4; ++i) atomicAdd(fixed_flux[(4 * channel + i) * count + k], int(round(c[i])));
  }
}
