// Rays from a visible surface through what the camera sees, thirty-two at once.
//
// A slice is a plane through the surface point x and the eye: on the image it is a line through the pixel. The slices
// stand at even angles φ about the way to the viewer, turned by a random one. Within a slice dω = |sinθ| dθ dφ and
// ⟨n,ω⟩ = m·cos(θ−γ), θ the angle from the way to the viewer, m and γ length and angle of the normal's part in the slice.
// The integral C of cos(θ−γ)|sinθ| is closed (below): ray k of 32 stands where C has reached (k + j)/32 of its whole W,
// j one random number a slice, and weighs m·W over the sum of all slices. So a weighted mean over all rays, times π, is
// ∫ … ⟨n,ω⟩₊ dω, exact for what is constant.
//
// The image line is walked outwards from the pixel. Each texel is a piece of its triangle's plane, as long as the step,
// and `thickness` metres thick along the view: it stops the rays that cross this quadrilateral, an interval of angles
// and so a run of bits (Therrien, Levesque and Gilet, "Screen Space Indirect Lighting with Visibility Bitmask", The
// Visual Computer 39, 2023, have the bitmask; they sample the hemisphere evenly in angle and take a texel for a point). A
// ray is stopped once, by the first texel out. It meets the front of the piece, which the camera sees, or another side of
// it, of which nothing is known. What reaches the border of the image within `radius` is unknown as well.
//
// The including file defines RADIANCE (1: vec3 front_radiance(ivec2 texel) says what a front sends, W/(m² sr)) and ENDED (1:
// spherical harmonics of the rays that end are summed up; hidden_ends says whether those on hidden sides do).
#ifndef LOOM_LIB_SCREEN_RAYS_GLSL
#define LOOM_LIB_SCREEN_RAYS_GLSL
#include "lib/camera.glsl"
#include "lib/math.glsl"
#include "lib/sampling.glsl"
#if ENDED
#include "lib/sh.glsl"
#endif

uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
// slices × 2 × steps stay below 65535, the rounds of loops after which llvmpipe ends a shader.
uniform int slices;
uniform int steps;
uniform float radius;     // metres
uniform float thickness;  // metres

// Shares of the rays, cosine-weighted; what is left of 1 is free within the radius.
struct ScreenRays {
  float front;   // end on what the camera sees
  float hidden;  // end on a side that it does not see
  float outside; // leave the image
  float under;   // go under the surface's own triangle, as a shading normal may have it: they carry nothing
  vec3 radiance; // sum over the first of what they meet, over all rays, W/(m² sr)
  vec3 behind;   // the same over the second, of the front of what they meet
#if ENDED
  // π/N·Σ Y over the rays that end: c00 c1−1 c10 c11, c2−2 c2−1 c20 c21, c22 (lib/sh_bands.glsl). Their irradiance in a
  // field of radiance coefficients L is Σ L·c.
  vec4 ended[3];
#endif
};

struct ScreenPoint {
  ivec2 pixel;
  float depth;
  vec3 offset;  // position less the eye
  vec3 n, n_g;  // shading and geometric normal
  vec3 v;       // unit, towards the viewer
};

struct ScreenSlice {
  vec3 across;     // unit, in the slice, square to v
  float gamma;     // of the normal's part in the slice
  vec2 turned;     // its cosine and sine
  float low, high; // angles between which ⟨n,ω⟩ > 0
  float first, scale, jitter;
  float weight;
};

vec3 origin_offset(Camera camera, vec2 uv) {
  return is_orthographic(camera) ? ray_origin(camera, uv) - camera.eye.xyz : vec3(0);
}

ScreenPoint screen_point(Camera camera, ivec2 pixel, float depth) {
  vec2 uv = pixel_uv(camera, pixel);
  ScreenPoint p;
  p.pixel = pixel;
  p.depth = depth;
  p.v = -ray_direction(camera, uv);
  p.offset = origin_offset(camera, uv) - depth * p.v;
  p.n = normalize_or(texelFetch(surface_normal, pixel, 0).xyz, p.v);
  p.n_g = normalize_or(texelFetch(surface_geometric_normal, pixel, 0).xyz, p.v);
  return p;
}

// C(θ) = ∫ cos(t−γ)|sin t| dt from 0 to θ = ±(¼(cos g − cos(2|θ|−g)) + ½|θ| sin g), g = ±γ. `turned`: cos g, sin g;
// `unit`: sin and cos of |θ|.
float slice_integral(vec2 turned, float angle, vec2 unit) {
  float cos2 = 2. * unit.y * unit.y - 1., sin2 = 2. * unit.x * unit.y;
  return .25 * (turned.x - cos2 * turned.x - sin2 * turned.y) + .5 * angle * turned.y;
}

float slice_integral(float gamma, float theta) {
  float side = theta < 0. ? -1. : 1., angle = abs(theta), g = side * gamma;
  return side * slice_integral(vec2(cos(g), sin(g)), angle, vec2(sin(angle), cos(angle)));
}

ScreenSlice screen_slice(ScreenPoint x, vec3 across, float jitter) {
  ScreenSlice s;
  s.across = across;
  vec2 n = vec2(dot(x.n, s.across), dot(x.n, x.v));
  s.gamma = atan(n.x, n.y);
  s.turned = vec2(cos(s.gamma), sin(s.gamma));
  s.low = max(s.gamma - .5 * pi, -pi);
  s.high = min(s.gamma + .5 * pi, pi);
  s.first = slice_integral(s.gamma, s.low);
  float whole = max(slice_integral(s.gamma, s.high) - s.first, 1e-6);
  s.scale = 32. / whole;
  s.jitter = jitter;
  s.weight = length(n) * whole;
  return s;
}

// How many of the slice's rays, counted from `low`, stand below the direction of p: coordinates along ±`across`, taken
// as no less than 0, and towards the viewer.
float ray_number(ScreenSlice s, float side, vec2 p) {
  p.x = max(p.x, 0.);
  p *= inversesqrt(max(dot(p, p), 1e-37));
  float angle = atan(p.x, p.y), theta = side * angle;
  float integral = side * slice_integral(vec2(s.turned.x, side * s.turned.y), angle, p);
  float number = theta <= s.low ? 0. : theta >= s.high ? 32. : (integral - s.first) * s.scale;
  return number - s.jitter;
}

#if ENDED
// `weight` times the basis in a unit direction.
void add_ended(vec3 w, float weight, inout ScreenRays sums) {
  sums.ended[0] += weight * sh2_basis(w);
  sums.ended[1] += weight * vec4(1.092548 * w.x * w.y, 1.092548 * w.y * w.z, .315392 * (3. * w.z * w.z - 1.), 1.092548 * w.x * w.z);
  sums.ended[2].x += weight * .546274 * (w.x * w.x - w.y * w.y);
}
#endif

uint rays_between(float a, float b) {
  int from = clamp(int(ceil(min(a, b))), 0, 32), to = clamp(int(ceil(max(a, b))), 0, 32);
  if (to <= from) return 0u;
  return (to - from == 32 ? ~0u : (1u << uint(to - from)) - 1u) << uint(from);
}

// Rays under the plane of the surface's own triangle.
uint rays_under(ScreenSlice s, ScreenPoint x) {
  // Where it cuts the slice on either side; flat shading has it at the ends.
  vec2 n = vec2(dot(x.n_g, s.across), dot(x.n_g, x.v));
  return ~rays_between(ray_number(s, -1., vec2(n.y, n.x)), ray_number(s, 1., vec2(n.y, -n.x)));
}

// Image-plane coordinates, in pixels, of an offset from the eye; false behind it.
bool to_pixels(Camera camera, vec3 offset, out vec2 at) {
  float z = dot(offset, camera.forward.xyz);
  vec2 s = vec2(dot(offset, camera.right.xyz) / dot(camera.right.xyz, camera.right.xyz),
                dot(offset, camera.up.xyz) / dot(camera.up.xyz, camera.up.xyz));
  if (!is_orthographic(camera)) s /= z;
  at = .5 * (s - vec2(camera.right.w, camera.up.w) + 1.) * camera.size.xy;
  return is_orthographic(camera) || z > 0.;
}

// Which way the image line of a slice runs, unit, in pixels: where x moves on the image when it moves along `across`.
vec2 image_line(Camera camera, ScreenPoint x, vec3 across) {
  float z = dot(x.offset, camera.forward.xyz), dz = dot(across, camera.forward.xyz);
  vec2 rr = vec2(dot(camera.right.xyz, camera.right.xyz), dot(camera.up.xyz, camera.up.xyz));
  vec2 s = vec2(dot(x.offset, camera.right.xyz), dot(x.offset, camera.up.xyz)) / rr;
  vec2 ds = vec2(dot(across, camera.right.xyz), dot(across, camera.up.xyz)) / rr;
  if (!is_orthographic(camera)) ds = ds * z - s * dz;
  vec2 line = ds * camera.size.xy;
  float length2 = dot(line, line);
  return length2 > 1e-37 ? line * inversesqrt(length2) : vec2(1, 0);
}

float to_border(vec2 from, vec2 line, vec2 size) {
  vec2 reciprocal = 1. / mix(line, vec2(1e-20), lessThan(abs(line), vec2(1e-20)));
  vec2 far = max(-from * reciprocal, (size - from) * reciprocal);
  return max(0., min(far.x, far.y));
}

// How far along the line, in pixels, the ball of the radius about x reaches; past any border where the eye is in it.
float ball_reach(Camera camera, ScreenPoint x, vec3 across, vec2 from) {
  vec3 edge;
  if (is_orthographic(camera)) {
    edge = x.offset + radius * across;
  } else {
    float sine = radius / x.depth;
    if (sine >= 1.) return 1e9;
    edge = sine * across - sqrt(1. - sine * sine) * x.v;
  }
  vec2 at;
  return to_pixels(camera, edge, at) ? distance(at, from) : 1e9;
}

// Coordinates in the slice relative to x: along `across`, which is ≥ 0 on this side, and towards the viewer.
vec2 in_slice(vec3 d, vec3 across, vec3 v) { return vec2(dot(d, across), dot(d, v)); }

// Rays that meet the view ray through the border of the image within the radius. `o`, `e`: its origin and direction.
uint rays_outside(ScreenSlice s, float side, vec2 o, vec2 e) {
  float b = -dot(o, e);
  vec2 foot = o + b * e;
  float square = radius * radius - dot(foot, foot);
  if (square <= 0.) return 0u;
  float near = max(0., b - sqrt(square)), far = b + sqrt(square);
  if (far <= 0.) return 0u;
  return rays_between(ray_number(s, side, o + near * e), ray_number(s, side, o + far * e));
}

// Where the view ray through uv meets a plane that another sees at `depth`; false where far from there, as it is seen
// nearly edge-on.
bool on_plane(Camera camera, vec2 uv, vec3 p, vec3 n, float depth, out vec3 met) {
  vec3 o = origin_offset(camera, uv), e = ray_direction(camera, uv);
  float t = dot(n, p - o) / dot(n, e);
  met = o + t * e;
  return t > .5 * depth && t < 2. * depth;
}

// One half of a slice. `taken`: rays that have ended.
void walk_side(Camera camera, ScreenPoint x, ScreenSlice s, float side, float within, inout uint taken,
               inout ScreenRays sums) {
  ivec2 size = textureSize(surface_depth, 0);
  vec2 from = vec2(x.pixel) + .5;
  vec3 across = side * s.across;
  vec2 line = image_line(camera, x, across);
  float border = to_border(from, line, vec2(size)), end = min(ball_reach(camera, x, across, from), border);

  // The pixel itself is its own plane. Steps grow by a power such that the first is one pixel.
  float inner = .5, span = end - inner;
  int count = span > 0. ? min(steps, int(ceil(span))) : 0;
  float power = count < steps ? 1. : max(1., log(span) / log(float(steps)));
  vec2 inner_uv = (from + inner * line) * camera.size.zw;
  // Where the last piece ended, its ray number there, and its length; a gap of less than half a piece is none.
  vec2 last = vec2(0);
  float last_number = 0., last_length = -1.;
  // Rays on this side of the way to the viewer.
  uint mine = rays_between(ray_number(s, side, vec2(0, 1)), side > 0. ? 32. : 0.);
  for (int i = 0; i < count && (mine & ~taken) != 0u; ++i) {
    float outer = .5 + span * pow(float(i + 1) / float(count), power);
    vec2 outer_uv = (from + outer * line) * camera.size.zw;
    vec2 at = from + mix(inner, outer, within) * line;
    ivec2 texel = clamp(ivec2(floor(at)), ivec2(0), size - 1);
    float depth = texelFetch(surface_depth, texel, 0).r;
    if (depth > 0. && texel != x.pixel) {
      vec2 uv = pixel_uv(camera, texel);
      vec3 e = ray_direction(camera, uv), p = origin_offset(camera, uv) + depth * e, d = p - x.offset;
      vec3 n = normalize_or(texelFetch(surface_geometric_normal, texel, 0).xyz, -e);
      // The piece, on the plane through the texel's point: where the line reads it, and both ends. An end that the view
      // cuts off (the plane is seen nearly edge-on) is left out.
      vec3 middle, a_end, b_end;
      float far2 = dot(d, d);
      if (far2 <= radius * radius && on_plane(camera, at * camera.size.zw, p, n, depth, middle)) {
        if (!on_plane(camera, inner_uv, p, n, depth, a_end)) a_end = middle;
        if (!on_plane(camera, outer_uv, p, n, depth, b_end)) b_end = middle;
        vec2 a = in_slice(a_end - x.offset, across, x.v), b = in_slice(b_end - x.offset, across, x.v);
        vec2 back = thickness * in_slice(e, across, x.v), a_back = a + back, b_back = b + back;
        vec4 numbers = vec4(ray_number(s, side, a), ray_number(s, side, b), ray_number(s, side, a_back),
                            ray_number(s, side, b_back));
        float size_ab = distance(a, b);
        if (distance(a, last) <= .5 * min(size_ab, last_length)) numbers.x = last_number;
        last = b;
        last_number = numbers.y;
        last_length = size_ab;
        uint whole = rays_between(min(min(numbers.x, numbers.y), min(numbers.z, numbers.w)),
                                  max(max(numbers.x, numbers.y), max(numbers.z, numbers.w))) &
                     ~taken;
        if (whole != 0u) {
          // Half-float normals tell no more than 2⁻¹⁰ of a plane's two sides.
          bool faces = -dot(n, d) > 9.765625e-4 * sqrt(far2);
          uint front = faces ? rays_between(numbers.x, numbers.y) & whole : 0u;
          float met = float(bitCount(front)), missed = float(bitCount(whole & ~front));
          sums.front += s.weight * met;
          sums.hidden += s.weight * missed;
#if ENDED
          // All of the piece's rays are taken to run to its middle, as it is seen from x.
          vec2 middle_ray = normalize(normalize(a) + normalize(b));
          float ends = met + (hidden_ends ? missed : 0.);
          add_ended(middle_ray.x * across + middle_ray.y * x.v, s.weight * ends, sums);
#endif
#if RADIANCE
          vec3 radiance = front_radiance(texel);
          sums.radiance += s.weight * met * radiance;
          sums.behind += s.weight * missed * radiance;
#endif
          taken |= whole;
        }
      }
    }
    inner = outer;
    inner_uv = outer_uv;
  }
  if (end >= border) {
    vec2 o = in_slice(origin_offset(camera, inner_uv) - x.offset, across, x.v);
    uint outside = rays_outside(s, side, o, in_slice(ray_direction(camera, inner_uv), across, x.v)) & ~taken;
    sums.outside += s.weight * float(bitCount(outside));
    taken |= outside;
  }
}

// `sequence`: sub-pixel samples of one pixel continue one sequence.
ScreenRays screen_rays(Camera camera, ScreenPoint x, uint seed, uint sequence) {
  ScreenRays sums;
  sums.front = sums.hidden = sums.outside = sums.under = 0.;
  sums.radiance = sums.behind = vec3(0);
#if ENDED
  sums.ended[0] = sums.ended[1] = sums.ended[2] = vec4(0);
#endif
  mat3 basis = orthonormal_basis(x.v);
  float turn = fract(to_unit(hash(uvec4(seed, 1u, 0u, 0u)).x) + to_unit(bitfieldReverse(sequence)));
  uint jitter_seed = hash(uvec4(seed, 2u, 0u, 0u)).x;
  float weights = 0.;
  for (int i = 0; i < slices; ++i) {
    vec2 jitter = low_discrepancy(sequence * uint(slices) + uint(i), jitter_seed);
    float angle = pi * (float(i) + turn) / float(slices);
    ScreenSlice s = screen_slice(x, cos(angle) * basis[0] + sin(angle) * basis[1], jitter.x);
    uint taken = rays_under(s, x);
    sums.under += s.weight * float(bitCount(taken));
    walk_side(camera, x, s, 1., jitter.y, taken, sums);
    walk_side(camera, x, s, -1., jitter.y, taken, sums);
    weights += s.weight;
  }
  float scale = 1. / (32. * max(weights, 1e-6));
  sums.front *= scale;
  sums.hidden *= scale;
  sums.outside *= scale;
  sums.under *= scale;
  sums.radiance *= scale;
  sums.behind *= scale;
#if ENDED
  for (int i = 0; i < 3; ++i) sums.ended[i] *= pi * scale;
#endif
  return sums;
}
#endif
