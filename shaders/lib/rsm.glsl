// Light faces: where a texel of a reflective shadow map looks, what it receives, and the virtual light that it makes.
#ifndef LOOM_LIB_RSM_GLSL
#define LOOM_LIB_RSM_GLSL
#include "interop/light.h"
#include "lib/math.glsl"

bool is_directional(LightFace face) { return int(face.forward.w) == LIGHT_DIRECTIONAL; }

// Plane coordinates q, −1…1 over the face, of the centre of a texel.
vec2 texel_plane(ivec2 texel, int size) { return (2. * vec2(texel) + 1.) / float(size) - 1.; }

// Along a perspective face: not unit, 1 along `forward`.
vec3 face_ray(LightFace face, vec2 q) { return face.forward.xyz + q.x * face.right.xyz + q.y * face.up.xyz; }

// World position of what the face sees at q at the stored distance (radial; directional: along the light).
vec3 face_position(LightFace face, vec2 q, float depth) {
  if (is_directional(face)) {
    return face.origin.xyz + q.x * face.right.xyz + q.y * face.up.xyz + depth * face.forward.xyz;
  }
  return face.origin.xyz + depth * normalize(face_ray(face, q));
}

// Plane coordinates of a position, and its distance z along `forward`; z ≤ 0 lies behind a perspective face, whose q
// then means nothing.
vec3 face_project(LightFace face, vec3 position) {
  vec3 p = position - face.origin.xyz;
  float z = dot(p, face.forward.xyz);
  vec2 q = vec2(dot(p, face.right.xyz) / dot(face.right.xyz, face.right.xyz),
                dot(p, face.up.xyz) / dot(face.up.xyz, face.up.xyz));
  return vec3(is_directional(face) ? q : q / z, z);
}

// True where the face looks at the position.
bool face_sees(vec3 projected) { return projected.z > 0. && all(lessThanEqual(abs(projected.xy), vec2(1))); }

// Solid angle of the texel at q, sr, by its centre: (2t/N)²/(1+x²+y²)^1.5. Within 1.5e-5 of the exact sum at 256²; the
// exact form cancels in 32 bits. Directional: the texel's area, m².
float texel_measure(LightFace face, vec2 q, int size) {
  float plane = 4. * length(face.right.xyz) * length(face.up.xyz) / (float(size) * float(size));
  if (is_directional(face)) return plane;
  vec3 ray = face_ray(face, q);
  float square = dot(ray, ray);
  return plane / (square * sqrt(square));
}

// Width of a texel at distance z along `forward`, metres.
float texel_width(LightFace face, float z, int size) {
  return 2. * length(face.right.xyz) / float(size) * (is_directional(face) ? 1. : z);
}

// Radiant intensity towards the unit direction w, W/sr: constant, times the smooth edge of glTF's spot,
// clamp((cos − cos_outer)/max(.001, cos_inner − cos_outer), 0, 1)². Directional: irradiance facing the light, W/m².
vec3 light_intensity(Light light, vec3 w) {
  if (int(light.position.w) != LIGHT_SPOT) return light.intensity.rgb;
  float edge = clamp((dot(w, light.direction.xyz) - light.cone.x) * light.cone.y, 0., 1.);
  return light.intensity.rgb * edge * edge;
}

// Irradiance at a position on a plane that faces the light, W/m², and the unit direction to the light.
vec3 light_irradiance(Light light, vec3 position, out vec3 to_light) {
  if (int(light.position.w) == LIGHT_DIRECTIONAL) {
    to_light = -light.direction.xyz;
    return light.intensity.rgb;
  }
  vec3 d = light.position.xyz - position;
  float square = dot(d, d);
  to_light = normalize_or(d, -light.direction.xyz);
  // A receiver in the light itself is lit without bound; keep it finite.
  return light_intensity(light, -to_light) / max(square, 1e-30);
}
#endif
