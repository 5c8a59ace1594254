#include "interop/scene.h"

// Locations as in framework/scene/vertex.h.
layout(location = 0) in vec3 vertex_position;
layout(location = 5) in uint draw_index;

layout(std430) readonly restrict buffer scene_draws { Draw draws[]; };
uniform mat4 view_proj;

void main() { gl_Position = view_proj * (draws[draw_index].world * vec4(vertex_position, 1)); }
