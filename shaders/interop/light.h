// A punctual light (KHR_lights_punctual; photometric numbers are used unconverted: cd as W/sr, lx as W/m²).
#ifndef LOOM_INTEROP_LIGHT_H
#define LOOM_INTEROP_LIGHT_H
#include "interop/interop.h"
#define LIGHT_POINT 0
#define LIGHT_SPOT 1
#define LIGHT_DIRECTIONAL 2
LOOM_INTEROP_BEGIN
struct Light {
  vec4 position;   // xyz: world, metres; w: LIGHT_*
  vec4 direction;  // xyz: unit, the way the light travels; w: first light face (layer) of this light
  vec4 intensity;  // rgb: point and spot W/sr, directional W/m² on a plane facing it; w: light faces (1 or 6)
  vec4 cone;       // spot: x = cos(outer), y = 1/max(.001, cos(inner) − cos(outer)), z = outer half-angle, radians
};
LOOM_STRUCT_SIZE(Light, 64);
// One layer of a LightLayers bundle: a perspective face of a spot or point light, or the box of a directional light.
struct LightFace {
  mat4 view_proj;  // reversed depth
  vec4 origin;     // xyz: light position (directional: centre of the near plane); w: index of the light
  vec4 right;      // xyz: as Camera, half-width of the image plane at distance 1 (directional: in metres);
                   // w: near plane, metres: hardware depth = w/z (directional: range, hardware depth = 1 − z/w)
  vec4 up;
  vec4 forward;    // xyz: unit; w: LIGHT_*
};
LOOM_STRUCT_SIZE(LightFace, 128);
// The bundle struct of LightLayers.
struct LightLayers {
  ivec4 count;     // x: light faces, y: lights, z: RSM size, w: shadow size, texels
};
LOOM_STRUCT_SIZE(LightLayers, 16);
LOOM_INTEROP_END
#endif
