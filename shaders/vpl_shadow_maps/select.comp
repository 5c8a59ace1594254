// Which lights get a map, and which of the maps have to be traced. One work group; each thread takes a row of lights.
//
// The `layers` brightest are found by a radix search over the bits of the flux, which order as the numbers do; of equal
// ones the first. A light is known again by its path and order. One that had a layer keeps it, and the others take
// those that are left, in order: the same on every run.
#include "interop/vpl.h"
#include "lib/vpls.glsl"
#define THREADS 256
layout(local_size_x = THREADS) in;
struct Owner {
  vec4 position;  // w: 1 + which light, 0 = none
  vec4 normal;
};
layout(std430) coherent restrict buffer persistent_owners { Owner owners[]; };
layout(std430) coherent restrict buffer persistent_places { uint places[]; };  // by path and order: 1 + layer
layout(std430) coherent restrict buffer scratch_todo { uint todo[]; };
layout(std430) coherent restrict buffer scratch_unused { uint unused[]; };
layout(std430) coherent restrict buffer shadows_of { uint map_of[]; };  // by light: 1 + layer, 0 = none
uniform int layers;
uniform int all;  // trace every map anew
#if COUNTS
writeonly uniform image2D counts_image;
#endif

shared uint bins[THREADS];
shared uint row[THREADS];
shared vec2 watts[THREADS];
shared uint prefix, left;

float flux_of(uint light) {
  vec3 flux = vpls[light].flux.rgb;
  return max(0., (flux.r + flux.g + flux.b) / 3.);
}
uint key_of(uint light) { return floatBitsToUint(flux_of(light)); }

// Which light this is, whatever its number is now.
uint identity(uint light) {
  uint orders = max(1u, uint(vpl_set.count.y));
  return min(uint(vpls[light].normal.w) * orders + uint(vpls[light].position.w) - 1u, uint(places.length()) - 1u);
}

// Sum of what the threads before this one say.
uint before(uint own) {
  uint thread = gl_LocalInvocationIndex;
  barrier();
  row[thread] = own;
  barrier();
  uint sum = 0u;
  for (uint i = 0u; i < thread; ++i) sum += row[i];
  return sum;
}

void finish_step() {
  memoryBarrierBuffer();
  memoryBarrierShared();
  barrier();
}

// The flux of the last light that gets a map, as bits, in `prefix`, and how many of that flux do, in `left`.
void find_threshold(uint first, uint end) {
  uint thread = gl_LocalInvocationIndex;
  if (thread == 0u) {
    prefix = 0u;
    left = uint(layers);
  }
  for (int shift = 24; shift >= 0; shift -= 8) {
    bins[thread] = 0u;
    finish_step();
    for (uint i = first; i < end; ++i) {
      uint key = key_of(i);
      if (shift == 24 || key >> uint(shift + 8) == prefix) atomicAdd(bins[key >> uint(shift) & 255u], 1u);
    }
    finish_step();
    if (thread == 0u) {
      uint digit = 255u;
      while (digit > 0u && bins[digit] < left) left -= bins[digit--];
      prefix = prefix << 8 | digit;
    }
    finish_step();
  }
}

void main() {
  uint thread = gl_LocalInvocationIndex, count = min(vpl_count(), uint(map_of.length()));
  uint first = thread * count / THREADS, end = (thread + 1u) * count / THREADS;
  uint slots = uint(layers), first_slot = thread * slots / THREADS, end_slot = (thread + 1u) * slots / THREADS;
  for (uint m = first_slot; m < end_slot; ++m) todo[m] = 0u;
  find_threshold(first, end);

  // Those that are chosen: of the threshold's flux, as many as are left, from the first on.
  uint equal = 0u;
  for (uint i = first; i < end; ++i) equal += key_of(i) == prefix ? 1u : 0u;
  uint taken = before(equal);
  // 1: has a layer, 2: has it and its map holds; those without are marked for the next step.
  const uint without = 0xffffffffu;
  uint needed = 0u;
  watts[thread] = vec2(0);
  for (uint i = first; i < end; ++i) {
    uint key = key_of(i);
    bool chosen = key > prefix || (key == prefix && taken++ < left);
    watts[thread] += flux_of(i) * vec2(chosen ? 1 : 0, 1);
    map_of[i] = 0u;
    if (!chosen) continue;
    uint light = identity(i), place = places[light];
    if (place > 0u && place <= slots && owners[place - 1u].position.w == float(light + 1u)) {
      Owner owner = owners[place - 1u];
      bool same = all == 0 && owner.position.xyz == vpls[i].position.xyz && owner.normal.xyz == vpls[i].normal.xyz;
      owners[place - 1u] = Owner(vec4(vpls[i].position.xyz, light + 1u), vec4(vpls[i].normal.xyz, 0));
      todo[place - 1u] = same ? 1u : 2u;
      map_of[i] = place;
    } else {
      map_of[i] = without;
      ++needed;
    }
  }
  finish_step();

  // Layers whose light is gone go to those that have none.
  uint free = 0u;
  for (uint m = first_slot; m < end_slot; ++m) free += todo[m] == 0u ? 1u : 0u;
  uint to = before(free);
  for (uint m = first_slot; m < end_slot; ++m) {
    if (todo[m] == 0u) unused[to++] = m;
  }
  uint from = before(needed);
  finish_step();
  for (uint i = first; i < end; ++i) {
    if (map_of[i] != without) continue;
    uint m = unused[min(from++, slots - 1u)], light = identity(i);
    places[light] = m + 1u;
    owners[m] = Owner(vec4(vpls[i].position.xyz, light + 1u), vec4(vpls[i].normal.xyz, 0));
    todo[m] = 2u;
    map_of[i] = m + 1u;
  }
  finish_step();
  uint traced = 0u;
  for (uint m = first_slot; m < end_slot; ++m) {
    if (todo[m] == 0u) owners[m] = Owner(vec4(0), vec4(0));
    traced += todo[m] == 2u ? 1u : 0u;
  }
#if COUNTS
  traced += before(traced);
  if (thread == THREADS - 1u) {
    vec2 sum = vec2(0);
    for (uint i = 0u; i < THREADS; ++i) sum += watts[i];
    imageStore(counts_image, ivec2(0), vec4(min(count, slots), traced, sum.y > 0. ? sum.x / sum.y : 0., count));
  }
#endif
}
