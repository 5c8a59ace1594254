// One ray through the depth image, after McGuire and Mara, "Efficient GPU Screen-Space Ray Tracing", JCGT 3(4), 2014, with
// surfaces as planes: each texel stands for the plane through what it sees, so that a ray meets a wall where the wall is,
// and not where a texel's depth says so.
//
// Along the image the ray runs straight. With P(t) = P₀ + t·P' in homogeneous pixels and D = P'_xy − S₀P'_w, S₀ = P₀_xy/P₀_w,
//   distance in the image  σ = t|D|/(P₀_w + tP'_w),   t = σP₀_w/(|D| − σP'_w).
// As long as the ray is in front of all that the picture shows, its way is free (`free`). Then it
//   meets a piece from the front (found), or leaves the image, or is lost: it meets a piece from behind, or at an edge
//   within `thickness` metres of what is seen. Behind that it passes, and may come out again.
// The including file defines `int steps` and `float thickness`, and the samplers surface_depth and
// surface_geometric_normal, and defines `bool seen_through(ivec2)`, for texels that show glass and not what is behind.
#ifndef LOOM_LIB_SCREEN_MARCH_GLSL
#define LOOM_LIB_SCREEN_MARCH_GLSL
#include "lib/camera.glsl"
#include "lib/math.glsl"
#define SCREEN_FOUND 0
#define SCREEN_LEFT 1
#define SCREEN_LOST 2
#define SCREEN_SKY 3  // runs on to where the picture shows nothing

struct ScreenMarch {
  int end;      // SCREEN_*
  ivec2 texel;  // what was met (FOUND), or hides it (LOST)
  float free;   // up to here nothing is in the way, m
};

// A piece of surface as a texel shows it.
struct Piece {
  vec3 position, normal;  // geometric
  float depth;            // 0: none
};

Piece piece_at(Camera camera, ivec2 texel) {
  float depth = texelFetch(surface_depth, texel, 0).r;
  vec2 uv = pixel_uv(camera, texel);
  vec3 e = ray_direction(camera, uv);
  return Piece(ray_origin(camera, uv) + depth * e, normalize_or(texelFetch(surface_geometric_normal, texel, 0).xyz, -e), depth);
}

float depth_of(Camera camera, vec3 p) {
  vec3 d = p - camera.eye.xyz;
  return is_orthographic(camera) ? dot(d, camera.forward.xyz) : length(d);
}

// In homogeneous pixels.
vec3 to_pixels(Camera camera, vec4 clip) { return vec3(.5 * camera.size.xy * (clip.xy + clip.w), clip.w); }

// x: origin, with the geometric normal n of its surface (0: in free space), seen over `extent`; w: unit. `within`: where in
// each step the image is read, [0,1).
ScreenMarch march_screen(Camera camera, vec3 x, vec3 w, vec3 n, float extent, float within) {
  ScreenMarch result = ScreenMarch(SCREEN_LOST, ivec2(-1), 0.);
  ivec2 size = textureSize(surface_depth, 0);
  vec3 from = to_pixels(camera, project(camera, x));
  vec3 way = to_pixels(camera, camera.proj * vec4(mat3(camera.view) * w, 0));
  if (!(from.z > 0.)) return result;
  vec2 start = from.xy / from.z, d = way.xy - start * way.z;
  float speed = length(d);
  if (!(speed > 1e-12)) return result;
  vec2 line = d / speed;
  // To the border, to where the ray vanishes, or to a thousandth of the distance from the eye's plane.
  vec2 reach = (mix(vec2(0), vec2(size), greaterThan(line, vec2(0))) - start) / mix(line, vec2(1e-6), lessThan(abs(line), vec2(1e-6)));
  float border = min(abs(line.x) < 1e-6 ? 1e30 : reach.x, abs(line.y) < 1e-6 ? 1e30 : reach.y), end = border;
  if (way.z > 0.) end = min(end, .9999 * speed / way.z);
  // P_w = P₀_w/1000 at t = .999·P₀_w/−P'_w: σ = t|D|/P_w.
  if (way.z < 0.) end = min(end, 999. * speed / -way.z);
  if (!(end > 0.)) return result;

  int count = min(steps, int(ceil(end)));
  // Steps grow by a power such that the first is one pixel.
  float power = count < steps ? 1. : max(1., log(max(end, 1.)) / log(float(max(steps, 2))));
  bool open = true;  // the ray has not passed behind anything yet
  bool in_front = false;  // of the last piece,
  vec3 met = vec3(0);     // which was there
  float t0 = 0.;
  vec3 m = abs(x);
  float rounding = 7.62939453125e-6 * (max(m.x, max(m.y, m.z)) + extent);
  for (int i = 0; i < count; ++i) {
    float inner = end * pow(float(i) / float(count), power), outer = end * pow(float(i + 1) / float(count), power);
    float t1 = outer * from.z / (speed - outer * way.z);
    ivec2 texel = clamp(ivec2(floor(start + mix(inner, outer, within) * line)), ivec2(0), size - 1);
    Piece y = piece_at(camera, texel);
    // What lies behind glass is not seen.
    if (y.depth > 0. && seen_through(texel)) {
      open = false;
      y.depth = 0.;
    }
    vec3 to_piece = y.position - x;
    float far = length(to_piece);
    // What lies behind the plane of x cannot be met: half-float normals tell no more than 2⁻¹⁰ of its two sides.
    bool ahead = n == vec3(0) || dot(n, to_piece) > rounding + 9.765625e-4 * far;
    if (y.depth > 0. && ahead) {
      float facing = dot(y.normal, w), s0 = t0 * facing - dot(y.normal, to_piece), s1 = s0 + (t1 - t0) * facing;
      // Pieces of a bent surface leave gaps where they meet: half a step, and no more than rounding elsewhere.
      float rounded = rounding + 9.765625e-4 * far, gap = .5 * (t1 - t0) * abs(facing);
      bool meets = in_front && abs(dot(y.normal, met - y.position)) <= gap;
      gap = meets ? max(gap, rounded) : rounded;
      if (facing < 0. && s0 > -gap && s1 < 0.) {
        result.end = SCREEN_FOUND;
        result.texel = texel;
        // The texel that shows the point itself, if it shows the same surface.
        float t = max(t0, t0 + s0 / -facing);
        vec3 p = x + t * w, at = to_pixels(camera, project(camera, p));
        ivec2 better = ivec2(floor(at.xy / at.z));
        if (all(greaterThanEqual(better, ivec2(0))) && all(lessThan(better, size))) {
          Piece z = piece_at(camera, better);
          bool same = z.depth > 0. && dot(z.normal, y.normal) > .9 && abs(dot(z.normal, p - z.position)) <= gap;
          if (same) result.texel = better;
        }
        return result;
      }
      if (min(s0, s1) < 0.) {
        float behind = depth_of(camera, x + .5 * (t0 + t1) * w) - y.depth;
        if (behind < thickness) {
          result.texel = texel;
          return result;
        }
        open = false;
      }
      in_front = min(s0, s1) >= 0.;
      met = y.position;
    }
    if (open) result.free = t1;
    t0 = t1;
  }
  ivec2 last = clamp(ivec2(floor(start + end * line)), ivec2(0), size - 1);
  bool sky = end < border && way.z > 0. && open && !(texelFetch(surface_depth, last, 0).r > 0.);
  result.end = sky ? SCREEN_SKY : end >= border || way.z < 0. ? SCREEN_LEFT : SCREEN_LOST;
  result.texel = ivec2(-1);
  return result;
}
#endif
