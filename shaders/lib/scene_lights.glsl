// The punctual lights; there are lights.length() of them.
#ifndef LOOM_LIB_SCENE_LIGHTS_GLSL
#define LOOM_LIB_SCENE_LIGHTS_GLSL
#include "interop/light.h"
layout(std430) readonly restrict buffer scene_lights { Light lights[]; };
#endif
