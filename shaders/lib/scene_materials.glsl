// The materials of the scene.
#ifndef LOOM_LIB_SCENE_MATERIALS_GLSL
#define LOOM_LIB_SCENE_MATERIALS_GLSL
#include "interop/scene.h"
layout(std430) readonly restrict buffer scene_materials { Material materials[]; };
#endif
