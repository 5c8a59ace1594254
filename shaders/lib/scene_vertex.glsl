// Vertex stage of every scene draw: call scene_vertex() and project what it returns. gl_InstanceID is the copy of the
// triangle (SceneView::draw, `instances`), for layered targets.
#ifndef LOOM_LIB_SCENE_VERTEX_GLSL
#define LOOM_LIB_SCENE_VERTEX_GLSL
#include "interop/scene.h"
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

// Fills the varyings; returns the world position.
vec3 scene_vertex() {
  vec3 position = (draws[draw_index].world * vec4(vertex_position, 1)).xyz;
  vertex.position = position;
  vertex.normal = mat3(draws[draw_index].normal) * vertex_normal;
  vertex.color = vertex_color;
#ifdef SCENE_TEXTURES
  vertex.uv = vertex_uv;
#endif
#ifdef SCENE_NORMAL_MAPS
  vertex.tangent = vec4(mat3(draws[draw_index].world) * vertex_tangent.xyz, vertex_tangent.w);
#endif
  vertex.ids = uvec4(draws[draw_index].material.xyz, draw_index);
  return position;
}
#endif
