// What the rasteriser and ray queries read of the scene, as storage blocks (shaders/lib).
#ifndef LOOM_INTEROP_SCENE_H
#define LOOM_INTEROP_SCENE_H
#include "interop/interop.h"
LOOM_INTEROP_BEGIN
// One drawn primitive (instance of a mesh primitive), indexed by the vertex attribute draw_index.
struct Draw {
  mat4 world;
  mat4 normal;     // inverse transpose of world, upper 3×3; [3][3] = −1 where the transform mirrors, else 1
  uvec4 material;  // x: index into scene_materials; y: its first triangle in scene_triangles; z: 1 where world mirrors
};
LOOM_STRUCT_SIZE(Draw, 144);
#define MATERIAL_BASE_COLOR_TEXTURE 1u
#define MATERIAL_NORMAL_TEXTURE 2u
#define MATERIAL_EMISSIVE_TEXTURE 4u
#define MATERIAL_METALLIC_TEXTURE 8u
#define MATERIAL_MASK 16u
#define MATERIAL_DOUBLE_SIDED 32u
#define MATERIAL_ALPHA_CLAMP_U 64u  // scene_alpha repeats; these clamp its u or v to the outermost texel centres
#define MATERIAL_ALPHA_CLAMP_V 128u
#define MATERIAL_SPECULAR 256u      // surfaces are ggx, and this one is metal, smoother than rough or transparent
struct TextureTransform {  // uv' = (row0 · (u,v,1), row1 · (u,v,1)); row0.w: UV set 0 or 1
  vec4 row0;
  vec4 row1;
};
LOOM_STRUCT_SIZE(TextureTransform, 32);
struct Material {
  vec4 base_color;   // linear Rec.709; a: alpha
  vec4 emissive;     // rgb: exitant radiance W/(m² sr); w: alpha cutoff
  vec4 factors;      // x: metallic, y: normal scale, z: roughness, w: transmission (0 where surfaces are lambert)
  uvec4 flags;       // x: MATERIAL_*; y: layer of scene_alpha (masked materials) or 0xffffffff
  TextureTransform base_color_uv, normal_uv, emissive_uv, metallic_uv;
  vec4 mean_albedo;  // rgb: diffuse albedo averaged over its textures, for ray hits (which sample no texture)
  vec4 dielectric;   // x: index of refraction
};
LOOM_STRUCT_SIZE(Material, 224);
// A triangle that emits, with its mean radiance (textures averaged over the triangle's area).
struct Emitter {
  vec4 a, b, c;      // xyz: corners, world, metres; a.w: area m²; b.w: 1 = emits on both sides; c.w: cumulative power share
  vec4 radiance;     // rgb: W/(m² sr), front side = counter-clockwise
};
LOOM_STRUCT_SIZE(Emitter, 64);
// Binary BVH. Inner node: count 0, left child at `first`, right at first+1. Leaf: triangles [first, first+count).
// No path from the root is longer than BVH_STACK nodes: a traversal keeps at most one postponed child a level.
#define BVH_STACK 64
struct BvhNode {
  vec4 lower;        // xyz; w: first, as bits of a uint
  vec4 upper;        // xyz; w: count, as bits of a uint
};
LOOM_STRUCT_SIZE(BvhNode, 32);
// Corners in world space, metres, counter-clockwise seen from the front whatever the transform of the instance.
struct BvhTriangle {
  vec4 a, b, c;      // a.w: material index as bits of a uint; b.w, c.w: alpha of the vertex colours at a and b
  vec4 uv_ab, uv_c;  // alpha-test coordinates (after the texture transform): a.xy b.zw, c.xy; uv_c.z: alpha at c
};
LOOM_STRUCT_SIZE(BvhTriangle, 80);
LOOM_INTEROP_END
#endif
