// Depth alone; what a mask cuts out casts no shadow.
#ifdef SCENE_ALPHA_MASK
#include "lib/material.glsl"
void main() {
  if (!surface_visible()) discard;
}
#else
void main() {}
#endif
