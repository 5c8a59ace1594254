// E_N = E_{N−1} + (e − E_{N−1})/N, with E_{N−1} where the last camera saw the same surface.
#include "lib/edge.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform surface_data { Camera camera; };
layout(std140) uniform last_surface_data { Camera last_camera; };
uniform sampler2D noisy_irradiance;
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D last_irradiance;
uniform sampler2D last_length_image;
uniform sampler2D last_surface_depth;
uniform sampler2D last_surface_normal;
uniform sampler2D surface_geometric_normal;
uniform sampler2D last_surface_geometric_normal;
writeonly uniform image2D irradiance_irradiance;
layout(r32f) writeonly uniform image2D length_image;
uniform bool has_history;
uniform int max_history;
uniform float plane_distance;
uniform float normal_angle;

// Where a camera without sub-pixel shift sees the point at `offset` from its eye: image-plane coordinates, half-widths.
// False where that is behind it.
bool seen_at(Camera c, vec3 offset, out vec2 s) {
  s = vec2(dot(offset, c.right.xyz) / dot(c.right.xyz, c.right.xyz), dot(offset, c.up.xyz) / dot(c.up.xyz, c.up.xyz));
  if (is_orthographic(c)) return true;
  float along = dot(offset, c.forward.xyz);
  s /= along;
  return along > 0.;
}

// World position less the camera's eye.
vec3 eye_offset(Camera c, ivec2 pixel, float depth) {
  vec2 uv = pixel_uv(c, pixel);
  return ray_origin(c, uv) - c.eye.xyz + depth * ray_direction(c, uv);
}

struct History {
  vec3 irradiance;
  float frames;  // 0: none
};

History history_of(ivec2 pixel, float depth) {
  History none = History(vec3(0), 0.);
  vec3 offset = eye_offset(camera, pixel, depth);
  vec3 between = camera.eye.xyz - last_camera.eye.xyz;
  vec2 s, last_s;
  if (!seen_at(camera, offset, s) || !seen_at(last_camera, offset + between, last_s)) return none;
  vec2 at = vec2(pixel) + .5 * camera.size.xy * (last_s - s);
  ivec2 size = textureSize(last_surface_depth, 0);
  // What lies far outside would overflow the conversion to integers.
  if (any(lessThan(at, vec2(-1))) || any(greaterThan(at, vec2(size)))) return none;

  vec3 normal = normalize_or(texelFetch(surface_normal, pixel, 0).xyz, vec3(0));
  vec3 plane = normalize_or(texelFetch(surface_geometric_normal, pixel, 0).xyz, vec3(0));
  float least_cosine = cos(radians(normal_angle));
  float footprint = pixel_footprint(camera, pixel_uv(camera, pixel), depth);
  ivec2 corner = ivec2(floor(at));
  vec2 f = at - vec2(corner);
  float weights = 0.;
  History sum = none;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1), tap = corner + step;
    vec2 axis = mix(1. - f, f, vec2(step));
    float weight = axis.x * axis.y;
    if (weight <= 0. || any(lessThan(tap, ivec2(0))) || any(greaterThanEqual(tap, size))) continue;
    float tap_depth = texelFetch(last_surface_depth, tap, 0).r;
    float frames = texelFetch(last_length_image, tap, 0).r;
    if (!(tap_depth > 0.) || !(frames > 0.)) continue;
    vec3 tap_normal = normalize_or(texelFetch(last_surface_normal, tap, 0).xyz, vec3(0));
    vec3 tap_plane = normalize_or(texelFetch(last_surface_geometric_normal, tap, 0).xyz, vec3(0));
    vec3 apart = eye_offset(last_camera, tap, tap_depth) - between - offset;
    float width = min(footprint, pixel_footprint(last_camera, pixel_uv(last_camera, tap), tap_depth));
    if (dot(normal, tap_normal) < least_cosine) continue;
    if (mutual_plane_distance(apart, plane, tap_plane) > plane_distance * width) continue;
    sum.irradiance += weight * texelFetch(last_irradiance, tap, 0).rgb;
    sum.frames += weight * frames;
    weights += weight;
  }
  if (weights <= 0.) return none;
  return History(sum.irradiance / weights, sum.frames / weights);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  History mean = History(vec3(0), 0.);
  if (depth > 0.) {
    if (has_history) mean = history_of(pixel, depth);
    vec3 e = texelFetch(noisy_irradiance, pixel, 0).rgb;
    if (is_finite(e)) {  // a frame that brings nothing leaves the mean as it is
      mean.frames = min(mean.frames + 1., float(max_history));
      mean.irradiance = max(vec3(0), mean.irradiance + (e - mean.irradiance) / mean.frames);
    }
  }
  imageStore(irradiance_irradiance, pixel, vec4(mean.irradiance, 1));
  imageStore(length_image, pixel, vec4(mean.frames));
}
