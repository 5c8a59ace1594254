// Injects one light's texels: each is a small Lambertian emitter of flux Φ, I(ω) += Φ/π·lobe(n), and a blocker of area
// A = r²·ω_texel/<n,−l>. The emitter moves half a cell along its normal, so that a wall does not light itself.
#include "inject/inject.glsl"
#include "interop/light.h"
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

float falloff(Light light, vec3 direction) {
  if (int(light.position.w) != LIGHT_SPOT) return 1.0;
  float t = clamp((dot(direction, light.direction.xyz) - light.cone.x) * light.cone.y, 0.0, 1.0);
  return t * t;
}

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
  vec2 p = 2.0 * (vec2(texel.xy) + 0.5) / vec2(size) - 1.0;
  vec3 across = p.x * face.right.xyz + p.y * face.up.xyz;
  float width = length(face.right.xyz), height = length(face.up.xyz);
  bool directional = int(face.forward.w) == LIGHT_DIRECTIONAL;

  vec3 direction, position;
  float facing_area;  // of the texel, on a plane that faces the light, at the surface
  vec3 received;      // flux that arrives in the texel
  float cell_area = 4.0 * width * height / float(size.x * size.y);
  if (directional) {
    direction = face.forward.xyz;
    position = face.origin.xyz + across + depth * direction;
    facing_area = cell_area;
    received = light.intensity.rgb * cell_area;
  } else {
    vec3 ray = face.forward.xyz + across;
    direction = normalize(ray);
    position = face.origin.xyz + depth * direction;
    float solid_angle = cell_area / pow(dot(ray, ray), 1.5);
    facing_area = depth * depth * solid_angle;
    received = light.intensity.rgb * falloff(light, direction) * solid_angle;
  }

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
