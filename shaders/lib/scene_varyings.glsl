// What the vertex stage hands to the fragment stage of every scene draw. The including file defines SCENE_VARYING as
// `out` or `in`. Members that the fragment stage does not use are removed when the program is linked.
// Switches, the same in both stages (loom::scene_defines):
//   SCENE_TEXTURES     some material has a texture
//   SCENE_NORMAL_MAPS  some material has a normal map
//   SCENE_ALPHA_MASK   some material is cut out by its alpha
#ifndef LOOM_LIB_SCENE_VARYINGS_GLSL
#define LOOM_LIB_SCENE_VARYINGS_GLSL
SCENE_VARYING SceneVaryings {
  vec3 position;  // world, metres
  vec3 normal;    // world, not unit
  vec4 color;     // linear; multiplies the base colour
  // Coordinates and flags are looked up at the vertices. In fragments, the lanes beside a triangle, which exist for
  // derivatives alone, may read zeros from a storage block (llvmpipe), and the mip level would be wrong along every edge.
#ifdef SCENE_TEXTURES
  vec2 base_color_uv, emissive_uv, metallic_uv;  // after the texture transform
#endif
#ifdef SCENE_NORMAL_MAPS
  vec2 normal_uv;
  vec4 tangent;  // world; w: ±1, side of the bitangent
#endif
  flat uvec4 ids;  // x: material, y: first triangle, z: MATERIAL_* and SCENE_MIRRORED, w: draw
} vertex;

// Copies every member; for a geometry stage in between.
#ifdef SCENE_TEXTURES
#define SCENE_COPY_UVS(to, from)           \
  to.base_color_uv = from.base_color_uv;   \
  to.emissive_uv = from.emissive_uv;       \
  to.metallic_uv = from.metallic_uv
#else
#define SCENE_COPY_UVS(to, from)
#endif
#ifdef SCENE_NORMAL_MAPS
#define SCENE_COPY_TANGENTS(to, from) \
  to.normal_uv = from.normal_uv;      \
  to.tangent = from.tangent
#else
#define SCENE_COPY_TANGENTS(to, from)
#endif
#define SCENE_COPY_VARYINGS(to, from) \
  to.position = from.position;        \
  to.normal = from.normal;            \
  to.color = from.color;              \
  SCENE_COPY_UVS(to, from);           \
  SCENE_COPY_TANGENTS(to, from);      \
  to.ids = from.ids

// The affine combination w of the three vertices of a triangle; for a geometry stage that draws another outline.
#ifdef SCENE_TEXTURES
#define SCENE_MIX_UVS(to, from, w)                        \
  to.base_color_uv = SCENE_MIX(from, base_color_uv, w);   \
  to.emissive_uv = SCENE_MIX(from, emissive_uv, w);       \
  to.metallic_uv = SCENE_MIX(from, metallic_uv, w)
#else
#define SCENE_MIX_UVS(to, from, w)
#endif
#ifdef SCENE_NORMAL_MAPS
#define SCENE_MIX_TANGENTS(to, from, w)           \
  to.normal_uv = SCENE_MIX(from, normal_uv, w);   \
  to.tangent = SCENE_MIX(from, tangent, w)
#else
#define SCENE_MIX_TANGENTS(to, from, w)
#endif
#define SCENE_MIX(from, member, w) ((w).x * from[0].member + (w).y * from[1].member + (w).z * from[2].member)
#define SCENE_MIX_VARYINGS(to, from, w)       \
  to.position = SCENE_MIX(from, position, w); \
  to.normal = SCENE_MIX(from, normal, w);     \
  to.color = SCENE_MIX(from, color, w);       \
  SCENE_MIX_UVS(to, from, w);                 \
  SCENE_MIX_TANGENTS(to, from, w);            \
  to.ids = from[0].ids

// Among the flags of `ids`: the transform turns counter-clockwise into clockwise.
#define SCENE_MIRRORED 0x80000000u
#endif
