// The surface elements that send light or block it: SOURCE says from where.
//   FROM_LIGHT     the texels of one light's reflective shadow map
//   FROM_EMISSION  where light of emitters and sky first meets a surface (emission.comp)
//   FROM_POINTS    the texels of a geometry image, whose members are called IMAGE_POSITION, IMAGE_NORMAL, IMAGE_ALBEDO and IMAGE_FLUX
// Each is a small Lambertian emitter of the flux Φ that it reflects; a texel has an area A = r²·ω_texel/<n,−l> too.
#define FROM_LIGHT 0
#define FROM_EMISSION 1
#define FROM_POINTS 2

struct Surfel {
  vec3 position, normal, flux;
  float area;  // 0: not known, adds no blocker
  vec3 albedo;
};

#if SOURCE == FROM_LIGHT
#include "lib/rsm.glsl"
#include "lib/scene_lights.glsl"
layout(std430) readonly buffer lights_faces { LightFace faces[]; };
uniform sampler2DArray lights_flux;
uniform sampler2DArray lights_normal;
uniform sampler2DArray lights_depth;
uniform int first_face;

bool read_surfel(int index, out Surfel surfel) {
  int size = textureSize(lights_flux, 0).x;
  ivec3 texel = ivec3(index % size, (index / size) % size, first_face + index / (size * size));
  surfel = Surfel(vec3(0), vec3(0), vec3(0), 0.0, vec3(0));
  if (texel.z >= textureSize(lights_flux, 0).z) return false;
  float depth = texelFetch(lights_depth, texel, 0).r;
  if (!(depth > 0.0)) return false;

  LightFace face = faces[texel.z];
  vec2 q = texel_plane(texel.xy, size);
  vec3 direction = is_directional(face) ? face.forward.xyz : normalize(face_ray(face, q));
  float measure = texel_measure(face, q, size);  // solid angle; directional: area
  surfel.position = face_position(face, q, depth);
  surfel.normal = normalize(texelFetch(lights_normal, texel, 0).xyz);
  surfel.flux = texelFetch(lights_flux, texel, 0).rgb;
  vec3 received = light_intensity(lights[int(face.origin.w)], direction) * measure;
  for (int channel = 0; channel < 3; ++channel) {
    if (received[channel] > 0.0) surfel.albedo[channel] = surfel.flux[channel] / received[channel];
  }
  float facing_area = is_directional(face) ? measure : depth * depth * measure;
  float cosine = dot(surfel.normal, -direction);
  if (cosine > 0.0) surfel.area = facing_area / cosine;
  return true;
}
#elif SOURCE == FROM_POINTS
uniform sampler2DArray IMAGE_POSITION;
uniform sampler2DArray IMAGE_NORMAL;
uniform sampler2DArray IMAGE_ALBEDO;
#ifdef IMAGE_FLUX
uniform sampler2DArray IMAGE_FLUX;
#endif
uniform int first_layer;

bool read_surfel(int index, out Surfel surfel) {
  ivec2 size = textureSize(IMAGE_POSITION, 0).xy;
  int row = index / size.x;
  ivec3 texel = ivec3(index - row * size.x, row % size.y, first_layer + row / size.y);
  surfel = Surfel(vec3(0), vec3(0), vec3(0), 0.0, vec3(0));
  if (texel.z >= textureSize(IMAGE_POSITION, 0).z) return false;
  vec4 position = texelFetch(IMAGE_POSITION, texel, 0);
  if (!(position.a > 0.0)) return false;
  surfel.position = position.xyz;
  surfel.area = position.a;
  surfel.normal = normalize(texelFetch(IMAGE_NORMAL, texel, 0).xyz);
  surfel.albedo = texelFetch(IMAGE_ALBEDO, texel, 0).rgb;
#ifdef IMAGE_FLUX
  surfel.flux = texelFetch(IMAGE_FLUX, texel, 0).rgb;
#endif
  return true;
}
#else
#include "inject/hit.glsl"
layout(std430) readonly buffer persistent_emission { EmissionHit emission[]; };

bool read_surfel(int index, out Surfel surfel) {
  surfel = Surfel(vec3(0), vec3(0), vec3(0), 0.0, vec3(0));
  if (index >= emission.length() || emission[index].normal.w == 0.0) return false;
  surfel.position = emission[index].position.xyz;
  surfel.normal = emission[index].normal.xyz;
  surfel.flux = emission[index].flux.rgb;
  return true;
}
#endif
