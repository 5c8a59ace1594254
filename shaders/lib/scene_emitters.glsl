// The triangles that emit; there are emitters.length() of them, at least one where the block exists.
#ifndef LOOM_LIB_SCENE_EMITTERS_GLSL
#define LOOM_LIB_SCENE_EMITTERS_GLSL
#include "interop/scene.h"
layout(std430) readonly restrict buffer scene_emitters { Emitter emitters[]; };

// Index of the emitter that holds the share u of all emitted power, u in [0,1), and the probability of choosing it.
int choose_emitter(float u, out float probability) {
  int low = 0, high = emitters.length() - 1;
  while (low < high) {
    int middle = (low + high) / 2;
    if (u < emitters[middle].c.w) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  probability = emitters[low].c.w - (low > 0 ? emitters[low - 1].c.w : 0.);
  return low;
}
#endif
