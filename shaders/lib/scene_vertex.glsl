// Vertex stage of every scene draw: call scene_vertex() and project what it returns. gl_InstanceID is the copy of the
// triangle (SceneView::draw, `instances`), for layered targets.
#ifndef LOOM_LIB_SCENE_VERTEX_GLSL
#define LOOM_LIB_SCENE_VERTEX_GLSL
#include "lib/scene_materials.glsl"
#define SCENE_VARYING out
#include "lib/scene_varyings.glsl"

// Locations as in framework/scene/vertex.h.
layout(location = 0) in vec3 vertex_position;
layout(location = 1) in vec3 vertex_normal;
layout(location = 2) in vec4 vertex_uv;
layout(location = 3) in vec4 vertex_color;
layout(location = 4) in vec4 vertex_tangent;
layout(location = 5) in uint draw_index;

layout(std430) readonly restrict buffer scene_draws { Draw draws[]; };

vec2 transform_uv(TextureTransform transform) {
  vec3 uv = vec3(transform.row0.w > .5 ? vertex_uv.zw : vertex_uv.xy, 1);
  return vec2(dot(transform.row0.xyz, uv), dot(transform.row1.xyz, uv));
}

// Fills the varyings; returns the world position.
vec3 scene_vertex() {
  uint material = draws[draw_index].material.x;
  vec3 position = (draws[draw_index].world * vec4(vertex_position, 1)).xyz;
  vertex.position = position;
  vertex.normal = mat3(draws[draw_index].normal) * vertex_normal;
  vertex.color = vertex_color;
#ifdef SCENE_TEXTURES
  vertex.base_color_uv = transform_uv(materials[material].base_color_uv);
  vertex.emissive_uv = transform_uv(materials[material].emissive_uv);
  vertex.metallic_uv = transform_uv(materials[material].metallic_uv);
#endif
#ifdef SCENE_NORMAL_MAPS
  vertex.normal_uv = transform_uv(materials[material].normal_uv);
  vertex.tangent = vec4(mat3(draws[draw_index].world) * vertex_tangent.xyz, vertex_tangent.w);
#endif
  uint mirrored = draws[draw_index].material.z != 0u ? SCENE_MIRRORED : 0u;
  vertex.ids = uvec4(material, draws[draw_index].material.y, materials[material].flags.x | mirrored, draw_index);
  return position;
}
#endif
