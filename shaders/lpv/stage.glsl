// One texel of one stage of propagation; STAGE says which. stage.comp and stage.frag write what it returns, and say how
// a volume is declared (STATE, BITS) and read (READ).
#include "lpv/state.glsl"

#define BEGIN 0    // an order starts, from the injected flux or from what surfaces reflected: front, sum
#define REFLECT 1  // what surfaces throw back of the front that starts: blocked
#define STEP 2     // light moves by one cell: front, sum, blocked

#if STAGE == BEGIN
uniform sampler3D flux_red;
#if FLUX_CHANNELS > 1
uniform sampler3D flux_green;
uniform sampler3D flux_blue;
#endif
#if BLOCKERS
uniform sampler3D scratch_blocked;
#endif
uniform int order;
uniform int cascade;
#else
STATE FROM;
#endif
#if BLOCKERS && STAGE != BEGIN
BITS scratch_open;     // x, y, z: share that a face lets through of light travelling (+, −) that axis
BITS scratch_reflect;  // [channel] B·ρ of the faces that light travelling (+, −) that axis leaves by
#endif

struct Result {
  vec4 front;    // what travels on, scaled to keep the flux
  vec4 sum;      // to be added to all light that has passed through the cell
  vec4 blocked;  // to be added to what its surfaces reflect: source of the next order
};

#if BLOCKERS && STAGE != BEGIN
vec4 reflected(ivec3 texel, Sent sent) {
  uvec4 bits = READ(scratch_reflect, texel);
  vec2 x = unpack_shares(bits.x) * sent.x, y = unpack_shares(bits.y) * sent.y, z = unpack_shares(bits.z) * sent.z;
  return lobes(x.x + x.y + y.x + y.y + z.x + z.y, vec3(x.y - x.x, y.y - y.x, z.y - z.x));
}
#endif

#if STAGE == STEP
// The state of the neighbour behind, seen along the way that light travels; dark outside the grid.
vec4 behind(ivec3 cell, int slab, ivec3 towards) {
  ivec3 at = cell - towards;
  bool inside = all(greaterThanEqual(at, ivec3(0))) && all(lessThan(at, grid.cells.xyz));
  vec4 state = READ(FROM, clamp(at, ivec3(0), grid.cells.xyz - 1) + ivec3(0, 0, slab));
  return inside ? state : vec4(0);
}

// All that the six neighbours send, as lobes about the normals of the faces that they send it through.
vec4 arrived(ivec3 cell, int slab) {
  float flux = 0.;
  vec3 normals = vec3(0);
#if BLOCKERS
  uvec4 bits = READ(scratch_open, cell);
  vec2 open[3] = vec2[3](unpack_shares(bits.x), unpack_shares(bits.y), unpack_shares(bits.z));
#else
  const vec2 open[3] = vec2[3](vec2(1), vec2(1), vec2(1));
#endif
  for (int k = 0; k < 2; ++k) {
    float sign = 1. - 2. * float(k);
    int step = 1 - 2 * k;
    vec4 s = behind(cell, slab, ivec3(step, 0, 0));
    vec4 f = open[0][k] * sent(s.x, sign * s.y, s.zw);
    flux += f.x;
    normals += vec3(sign * f.y, f.z, f.w);
    s = behind(cell, slab, ivec3(0, step, 0));
    f = open[1][k] * sent(s.x, sign * s.z, s.yw);
    flux += f.x;
    normals += vec3(f.z, sign * f.y, f.w);
    s = behind(cell, slab, ivec3(0, 0, step));
    f = open[2][k] * sent(s.x, sign * s.w, s.yz);
    flux += f.x;
    normals += vec3(f.z, f.w, sign * f.y);
  }
  return lobes(flux, normals);
}
#endif

Result stage(ivec3 texel) {
  Result result = Result(vec4(0), vec4(0), vec4(0));
  // By comparison: SIMD has no integer division.
  int channel = int(texel.z >= grid.cells.z) + int(texel.z >= 2 * grid.cells.z), slab = channel * grid.cells.z;
#if STAGE == REFLECT
#if BLOCKERS
  result.blocked = reflected(texel, sent_to_neighbours(READ(FROM, texel)));
#endif
#else
#if STAGE == BEGIN
#if BLOCKERS
  if (order > 0) result.sum = texelFetch(scratch_blocked, texel, 0);
#endif
  if (order == 0) {
    ivec3 at = texel + ivec3(0, 0, cascade * grid.cells.z - slab);
    vec4 flux = texelFetch(flux_red, at, 0);
#if FLUX_CHANNELS > 1
    vec4 green = texelFetch(flux_green, at, 0), blue = texelFetch(flux_blue, at, 0);
    flux = channel == 0 ? flux : channel == 1 ? green : blue;
#endif
    result.sum = from_sh(flux);
  }
#else
  result.sum = arrived(texel - ivec3(0, 0, slab), slab);
#endif
  Sent sent = sent_to_neighbours(result.sum);
  result.front = keep_flux(result.sum, sent);
#if BLOCKERS && STAGE == STEP
  result.blocked = reflected(texel, sent);
#endif
#endif
  return result;
}
