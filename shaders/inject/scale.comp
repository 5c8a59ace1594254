// Fixed-point units a W/sr for a source whose power is not known beforehand: the sum of all its flux, in one coefficient
// (at most 1.0234/π of a flux), stays below 2³⁰. One work group adds in a fixed order.
#include "inject/source.glsl"
layout(local_size_x = 256) in;

layout(std430) writeonly buffer scratch_scale { float flux_scale; };
uniform int elements;
shared float partial[256];

void main() {
  int self = int(gl_LocalInvocationID.x);
  vec3 sum = vec3(0);
  for (int i = self; i < elements; i += 256) {
    Surfel surfel;
    if (read_surfel(i, surfel)) sum += surfel.flux;
  }
  partial[self] = max(sum.r, max(sum.g, sum.b));
  barrier();
  if (self != 0) return;
  float power = 0.;
  for (int i = 0; i < 256; ++i) power += partial[i];
  flux_scale = power > 0. ? 1073741824. / (power * (1.0234 / 3.14159265)) : 0.;
}
