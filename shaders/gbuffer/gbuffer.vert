#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/scene_vertex.glsl"

layout(std140) uniform frame_data { FrameData frame; };

void main() { gl_Position = project(frame.camera, scene_vertex()); }
