// Rays against the scene's BVH. Nothing is culled; masked materials are cut out by their alpha.
// Compile with SCENE_ALPHA_MASK where the scene has masked materials (loom::scene_defines).
#ifndef LOOM_LIB_TRACE_GLSL
#define LOOM_LIB_TRACE_GLSL
#include "lib/math.glsl"
#include "lib/scene_materials.glsl"

layout(std430) readonly restrict buffer scene_bvh_nodes { BvhNode bvh_nodes[]; };
layout(std430) readonly restrict buffer scene_bvh_triangles { BvhTriangle bvh_triangles[]; };

#ifdef SCENE_ALPHA_MASK
uniform sampler2DArray scene_alpha;
#endif

struct Hit {
  float t;            // in lengths of the direction; no_hit where nothing was hit
  uint triangle;      // index into bvh_triangles
  vec2 barycentrics;  // the point is (1−x−y)·a + x·b + y·c
};

const float no_hit = 3.402823466e38;
bool is_hit(Hit hit) { return hit.t < no_hit; }

// Error of a surface position in units of the magnitudes that made it: rasterised depth, transforms and ray arithmetic
// in 24-bit floats stay below 2⁻²⁰ of max(|position|, |eye|, depth); one more factor 4 covers vertices that the
// rasteriser and the BVH round differently, and slanted offsets. At 10 m from the origin this is .04 mm.
const float position_error = 3.814697265625e-6;  // 2⁻¹⁸

// A ray origin that is safely on the side of `normal` (unit, geometric). `extent`: the distance over which the position
// was computed (depth of the G-buffer, length of the ray that hit), metres.
vec3 offset_origin(vec3 position, vec3 normal, float extent) {
  vec3 m = abs(position);
  return position + normal * (position_error * (max(m.x, max(m.y, m.z)) + extent));
}

// A zero component would make 0·∞ in the slab test; 1e-20 moves the ray by less than an ulp of any distance.
vec3 reciprocal_direction(vec3 direction) {
  return 1. / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
}

// Distance at which the ray enters the box, or no_hit. The exit is widened by the rounding of three operations
// (2·γ₃, Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013): a box that is touched is never missed.
float enter_box(vec3 lower, vec3 upper, vec3 origin, vec3 reciprocal, float t_max) {
  vec3 t0 = (lower - origin) * reciprocal;
  vec3 t1 = (upper - origin) * reciprocal;
  vec3 near = min(t0, t1), far = max(t0, t1);
  float enter = max(max(near.x, near.y), max(near.z, 0.));
  float leave = min(min(far.x, far.y), min(far.z, t_max)) * (1. + 3.6e-7);
  return enter <= leave ? enter : no_hit;
}

// The ray as the z axis of a space in which its origin is 0 and t is z: the largest component of the direction turns
// into z, and a shear moves the others to 0. Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
struct RaySpace {
  vec3 origin;
  vec3 shear;
  int axis;
};

vec3 turn(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }

RaySpace ray_space(vec3 origin, vec3 direction) {
  vec3 m = abs(direction);
  int axis = m.z >= max(m.x, m.y) ? 2 : m.y >= m.x ? 1 : 0;
  vec3 d = turn(direction, axis);
  return RaySpace(origin, vec3(d.xy, 1) / d.z, axis);
}

// `precise` here and below: a vertex lands on the same place, and an edge gets the same sign, in each triangle that
// shares it. Rounded products keep their order, so that the sign of their difference is right or 0, and 0 counts as
// inside: no ray slips between two triangles.
vec3 to_ray_space(RaySpace space, vec3 point) {
  precise vec3 p = turn(point - space.origin, space.axis);
  precise vec3 q = vec3(p.xy - space.shear.xy * p.z, p.z * space.shear.z);
  return q;
}

float edge_side(vec3 p, vec3 q) {
  precise float side = p.x * q.y - p.y * q.x;
  return side;
}

// True where the ray meets the triangle in (0, t_max).
bool intersect_triangle(uint index, RaySpace space, float t_max, out float t, out vec2 barycentrics) {
  vec3 a = to_ray_space(space, bvh_triangles[index].a.xyz);
  vec3 b = to_ray_space(space, bvh_triangles[index].b.xyz);
  vec3 c = to_ray_space(space, bvh_triangles[index].c.xyz);
  vec3 weight = vec3(edge_side(b, c), edge_side(c, a), edge_side(a, b));
  float low = min(weight.x, min(weight.y, weight.z)), high = max(weight.x, max(weight.y, weight.z));
  float sum = weight.x + weight.y + weight.z;
  if ((low < 0. && high > 0.) || sum == 0.) return false;
  barycentrics = weight.yz / sum;
  t = dot(weight, vec3(a.z, b.z, c.z)) / sum;
  return t > 0. && t < t_max;
}

// False where the mask of the triangle's material cuts the point away.
bool opaque_at(uint index, vec2 barycentrics) {
#ifdef SCENE_ALPHA_MASK
  uint material = floatBitsToUint(bvh_triangles[index].a.w);
  uvec4 flags = materials[material].flags;
  if ((flags.x & MATERIAL_MASK) == 0u) return true;
  vec4 uv_ab = bvh_triangles[index].uv_ab, uv_c = bvh_triangles[index].uv_c;
  vec3 weight = vec3(1. - barycentrics.x - barycentrics.y, barycentrics);
  vec2 uv = weight.x * uv_ab.xy + weight.y * uv_ab.zw + weight.z * uv_c.xy;
  vec2 edge = .5 / vec2(textureSize(scene_alpha, 0).xy);
  if ((flags.x & MATERIAL_ALPHA_CLAMP_U) != 0u) uv.x = clamp(uv.x, edge.x, 1. - edge.x);
  if ((flags.x & MATERIAL_ALPHA_CLAMP_V) != 0u) uv.y = clamp(uv.y, edge.y, 1. - edge.y);
  float vertex_alpha = dot(weight, vec3(bvh_triangles[index].b.w, bvh_triangles[index].c.w, uv_c.z));
  float alpha = vertex_alpha * materials[material].base_color.a;
  if ((flags.x & MATERIAL_BASE_COLOR_TEXTURE) != 0u) alpha *= textureLod(scene_alpha, vec3(uv, flags.y), 0.).r;
  return alpha >= materials[material].emissive.w;
#else
  return true;
#endif
}

// The nearest hit in (0, t_max), or with `any` the first one found. Children wait on the stack with the place of their
// content: first << 4 | count.
Hit traverse(vec3 origin, vec3 direction, float t_max, bool any) {
  Hit hit = Hit(no_hit, 0u, vec2(0));
  vec3 reciprocal = reciprocal_direction(direction);
  RaySpace space = ray_space(origin, direction);
  uint stack[BVH_STACK];
  int top = 0;
  vec4 root = bvh_nodes[0].upper;
  uint node = floatBitsToUint(bvh_nodes[0].lower.w) << 4 | floatBitsToUint(root.w);
  bool walking = enter_box(bvh_nodes[0].lower.xyz, root.xyz, origin, reciprocal, t_max) < no_hit;
  while (walking) {
    uint first = node >> 4, count = node & 15u;
    bool descend = false;
    for (uint i = first; i < first + count; ++i) {
      float t;
      vec2 barycentrics;
      if (intersect_triangle(i, space, t_max, t, barycentrics) && opaque_at(i, barycentrics)) {
        hit = Hit(t, i, barycentrics);
        if (any) return hit;
        t_max = t;
      }
    }
    if (count == 0u) {
      vec4 lower0 = bvh_nodes[first].lower, upper0 = bvh_nodes[first].upper;
      vec4 lower1 = bvh_nodes[first + 1u].lower, upper1 = bvh_nodes[first + 1u].upper;
      float t0 = enter_box(lower0.xyz, upper0.xyz, origin, reciprocal, t_max);
      float t1 = enter_box(lower1.xyz, upper1.xyz, origin, reciprocal, t_max);
      uint node0 = floatBitsToUint(lower0.w) << 4 | floatBitsToUint(upper0.w);
      uint node1 = floatBitsToUint(lower1.w) << 4 | floatBitsToUint(upper1.w);
      bool swap = t1 < t0;
      node = swap ? node1 : node0;
      descend = min(t0, t1) < no_hit;
      if (max(t0, t1) < no_hit && top < BVH_STACK) stack[top++] = swap ? node0 : node1;
    }
    if (!descend) {
      walking = top > 0;
      if (walking) node = stack[--top];
    }
  }
  return hit;
}

// True where something opaque lies on the ray in (0, t_max), in lengths of `direction`.
bool occluded(vec3 origin, vec3 direction, float t_max) { return is_hit(traverse(origin, direction, t_max, true)); }

// True where something lies between two surface points; normals unit and geometric, extents as in offset_origin().
bool segment_occluded(vec3 p, vec3 p_normal, float p_extent, vec3 q, vec3 q_normal, float q_extent) {
  vec3 from = offset_origin(p, p_normal, p_extent);
  vec3 to = offset_origin(q, q_normal, q_extent);
  return occluded(from, to - from, 1.);
}

Hit closest_hit(vec3 origin, vec3 direction, float t_max) { return traverse(origin, direction, t_max, false); }

uint hit_material(Hit hit) { return floatBitsToUint(bvh_triangles[hit.triangle].a.w); }

// From the corners, not along the ray: the error is that of the corners, however long the ray.
vec3 hit_position(Hit hit) {
  return (1. - hit.barycentrics.x - hit.barycentrics.y) * bvh_triangles[hit.triangle].a.xyz +
         hit.barycentrics.x * bvh_triangles[hit.triangle].b.xyz + hit.barycentrics.y * bvh_triangles[hit.triangle].c.xyz;
}

// Unit geometric normal of the front side.
vec3 hit_normal(Hit hit) {
  vec3 a = bvh_triangles[hit.triangle].a.xyz;
  return normalize_or(cross(bvh_triangles[hit.triangle].b.xyz - a, bvh_triangles[hit.triangle].c.xyz - a), vec3(0, 1, 0));
}

// Diffuse albedo of the material, its textures averaged.
vec3 hit_albedo(Hit hit) { return materials[hit_material(hit)].mean_albedo.rgb; }
#endif
