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
#ifdef SCENE_TEXTURES
  vec4 uv;        // xy: set 0, zw: set 1
#endif
#ifdef SCENE_NORMAL_MAPS
  vec4 tangent;   // world; w: ±1, side of the bitangent
#endif
  flat uvec4 ids;  // x: material, y: first triangle, z: 1 = mirrored (Draw::material); w: draw
} vertex;
#endif
