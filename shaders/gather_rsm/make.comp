// Texels to virtual lights: A = r²·ω/⟨n,−l⟩ (directional: A_texel/⟨n,−l⟩).
#include "lib/rsm.glsl"
#define SCRATCH_ACCESS writeonly restrict
#include "gather_rsm/virtual_light.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430) readonly restrict buffer lights_faces { LightFace faces[]; };
uniform sampler2DArray lights_flux;
uniform sampler2DArray lights_normal;
uniform sampler2DArray lights_depth;

void main() {
  ivec3 size = textureSize(lights_flux, 0);
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, size))) return;
  LightFace face = faces[texel.z];
  vec2 q = texel_plane(texel.xy, size.x);
  float depth = texelFetch(lights_depth, texel, 0).r;
  float measure = texel_measure(face, q, size.x);
  vec3 normal = normalize_or(texelFetch(lights_normal, texel, 0).xyz, vec3(0, 1, 0));
  vec3 towards = is_directional(face) ? face.forward.xyz : normalize(face_ray(face, q));
  float area = (is_directional(face) ? measure : depth * depth * measure) / max(-dot(normal, towards), 1e-6);
  vec3 flux = depth > 0. ? texelFetch(lights_flux, texel, 0).rgb : vec3(0);
  VirtualLight made;
  made.position = vec4(face_position(face, q, depth), area * inverse_pi);
  made.intensity = vec4(flux * inverse_pi, uintBitsToFloat(pack_normal(normal)));
  virtual_lights[(texel.z * size.y + texel.y) * size.x + texel.x] = made;
}
