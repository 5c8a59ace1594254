// What the virtual lights give one pixel, E(x) = Σ (Φ_j/π) ⟨n_j, x−x_j⟩₊⟨n, x_j−x⟩₊ / (r²(r² + m²A/π))
#define METHOD_importance 0
#define METHOD_full 1
#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/rsm.glsl"
#include "lib/sampling.glsl"
#include "lib/scene_lights.glsl"
#define SCRATCH_ACCESS readonly restrict
#include "gather_rsm/virtual_light.glsl"
layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
layout(std430) readonly restrict buffer lights_faces { LightFace faces[]; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform ivec3 map;  // texels, texels, faces
uniform int samples;
#include "lib/parts.glsl"
uniform float radius;
uniform float min_distance;

int texel_index(ivec2 texel, int layer) { return (layer * map.y + texel.y) * map.x + texel.x; }

// What one virtual light gives, bounded, and what the bound took away.
void add_light(int index, vec3 x, vec3 n, float weight, inout vec3 given, inout vec3 taken) {
  vec4 position = virtual_lights[index].position, intensity = virtual_lights[index].intensity;
  vec3 d = position.xyz - x;
  float square = max(dot(d, d), 1e-30);
  float cosines = max(0., dot(n, d)) * max(0., -dot(unpack_normal(floatBitsToUint(intensity.w)), d)) / square;
  vec3 e = intensity.rgb * (weight * cosines);
  float softened = square + min_distance * min_distance * position.w;
  given += e / softened;
#if CLAMPED
  taken += e * (1. / square - 1. / softened);
#endif
}

#if METHOD == METHOD_importance
// Point `index` of Roberts' R2 sequence (multiples of 1/g and 1/g², g³ = g + 1), rotated by `offset`: as cheap as two
// multiplications, which tells where there is a sample for every few instructions.
vec2 rotated_r2(uint index, uvec2 offset) {
  uvec2 bits = offset + index * uvec2(3242174889u, 2447445414u);
  return vec2(to_unit(bits.x), to_unit(bits.y));
}

// Where the light sees x: on a single face its plane coordinates, on six the unit direction.
struct Centre {
  bool planar;
  vec2 q;
  vec3 direction;
  float reach;  // planar: R in plane coordinates (a map is 2 wide); six faces: Θ, radians
};

Centre centre_of(Light light, vec3 x) {
  Centre centre;
  centre.planar = int(light.intensity.w) == 1;
  centre.direction = normalize_or(x - light.position.xyz, vec3(0, -1, 0));
  centre.reach = centre.planar ? 2. * radius : min(.5 * pi * radius, pi);
  centre.q = vec2(0);
  if (centre.planar) {
    LightFace face = faces[int(light.direction.w)];
    vec3 projected = face_project(face, x);
    // What the map does not see is taken at the nearest point of its border; behind the light that is where the
    // direction leaves it.
    if (!is_directional(face) && projected.z <= 0.) projected.xy *= -1e6;
    centre.q = clamp(projected.xy, vec2(-1), vec2(1));
  }
  return centre;
}

// The face of a six-faced light (+X −X +Y −Y +Z −Z) that looks along w.
int cube_face(vec3 w) {
  vec3 m = abs(w);
  int axis = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
  return 2 * axis + (w[axis] < 0. ? 1 : 0);
}

// One texel around the centre; −1 where the map ends.
int choose_texel(Light light, Centre centre, vec2 u, out float weight) {
  int layer = int(light.direction.w);
  float r = centre.reach * u.x, angle = 2. * pi * u.y;
  vec2 q;
  if (centre.planar) {
    q = centre.q + r * vec2(cos(angle), sin(angle));
    // 2πR²ξ₁/(N·a) in plane coordinates, where a texel's area is 4/N².
    weight = 2. * pi * centre.reach * r * .25 * float(map.x) * float(map.y) / float(samples_of_part(samples));
  } else {
    vec3 w = orthonormal_basis(centre.direction) * vec3(sin(r) * vec2(cos(angle), sin(angle)), cos(r));
    layer += cube_face(w);
    vec3 projected = face_project(faces[layer], faces[layer].origin.xyz + w);
    q = clamp(projected.xy, vec2(-1), vec2(.9999999));
    // The inverse of the texel's solid angle 4z³/N², z along the face's axis.
    weight = 2. * pi * centre.reach * sin(r) / float(samples_of_part(samples)) * .25 * float(map.x) * float(map.y) /
             (projected.z * projected.z * projected.z);
  }
  ivec2 texel = ivec2(floor(.5 * (q + 1.) * vec2(map.xy)));
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, map.xy))) return -1;
  return texel_index(texel, layer);
}

bool within(Centre centre, LightFace face, vec2 q) {
  if (centre.planar) return distance(q, centre.q) <= centre.reach;
  return dot(normalize(face_ray(face, q)), centre.direction) >= cos(centre.reach);
}
#endif

struct Gathered {
  vec3 given;   // within the radius, bounded
  vec3 taken;   // by the bound
  vec3 missed;  // outside the radius
};

Gathered gathered_at(ivec2 pixel) {
  Gathered sums = Gathered(vec3(0), vec3(0), vec3(0));
  vec3 ignored = vec3(0);
  vec3 x = surface_position(camera, pixel_uv(camera, pixel), texelFetch(surface_depth, pixel, 0).r);
  vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
#if METHOD == METHOD_full
  for (int i = 0; i < lights.length(); ++i) {
    int first = int(lights[i].direction.w), faces_of = int(lights[i].intensity.w);
    bool cone = int(lights[i].position.w) == LIGHT_SPOT && faces_of == 1;
    // A part takes every n-th row, and counts it n times.
    for (int row = first * map.y + part.x; row < (first + faces_of) * map.y; row += part.y) {
      // A spot lights the circle |q| < 1 of its face: what lies outside reflects exactly nothing.
      float v = (2. * float(row % map.y) + 1.) / float(map.y) - 1.;
      int left = cone ? max(0, int(.5 * float(map.x) * (1. - sqrt(max(0., 1. - v * v)))) - 1) : 0;
      for (int k = left; k < map.x - left; ++k) add_light(row * map.x + k, x, n, float(part.y), sums.given, sums.taken);
    }
  }
#else
  uint seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x72736du);
  for (int i = 0; i < lights.length(); ++i) {
    Centre centre = centre_of(lights[i], x);
    uvec2 offset = hash(uvec4(seed, uint(i), 0u, 0u)).xy;
    int count = samples_of_part(samples);
    for (int k = 0; k < count; ++k) {
      float weight;
      vec2 u = rotated_r2(stretch_of_part(frame.random.z) * uint(count) + uint(k), offset);
      int index = choose_texel(lights[i], centre, u, weight);
      if (index >= 0) add_light(index, x, n, weight, sums.given, sums.taken);
    }
#if MISSED
    for (int f = 0; f < int(lights[i].intensity.w); ++f) {
      int layer = int(lights[i].direction.w) + f;
      for (int t = 0; t < map.x * map.y; ++t) {
        ivec2 texel = ivec2(t % map.x, t / map.x);
        if (within(centre, faces[layer], texel_plane(texel, map.x))) continue;
        add_light(texel_index(texel, layer), x, n, 1., sums.missed, ignored);
      }
    }
#endif
  }
#endif
  return sums;
}
