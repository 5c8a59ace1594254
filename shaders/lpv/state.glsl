// The propagation state. A cell of intensity I(ω) = m + ⟨v,ω⟩ [W/sr] is one vec4 (m, v) a
// channel; red, green and blue lie one behind the other in the slices of a volume. In these terms the lobe Φ/π·⟨n,ω⟩₊
// of two SH bands is m = Φ/4π, v = Φ·n/2π, and all that a cell sends is 4π·m.
#include "interop/grid.h"
#include "lib/sh.glsl"
#include "lib/storage.glsl"

layout(std140) uniform flux_data { Grid grid; };

const float pi = 3.14159265358979;

// Solid angles of a neighbour's faces, seen from the centre of a cell of size 1: the front face at distance 1.5, a
// side face. One front and four sides make up the cell face in between: 4π/6.
const float FRONT_SOLID_ANGLE = 0.4006696847;
const float SIDE_SOLID_ANGLE = 0.4234313544;
// The centre of a side face stands at (1, ½): cosine and sine of its direction, 2/√5 and 1/√5.
const float SIDE_COSINE = 0.89442719;
const float SIDE_SINE = 0.44721360;

vec4 from_sh(vec4 c) { return vec4(SH_Y0 * c.x, SH_Y1 * c.wyz); }
vec4 to_sh(vec4 state) { return vec4(state.x / SH_Y0, state.zwy / SH_Y1); }
vec4 lobes(float flux, vec3 weighted_normals) { return vec4(flux / (4. * pi), weighted_normals / (2. * pi)); }

// What a cell sends through the five far faces of the neighbour in one direction: in all, through the front face, and
// the differences between opposite side faces. `along`: component of v in that direction, `across`: the other two.
vec4 sent(float mean, float along, vec2 across) {
  float front = FRONT_SOLID_ANGLE * max(0., mean + along);
  float middle = mean + SIDE_COSINE * along;
  vec2 plus = max(vec2(0), middle + SIDE_SINE * across);
  vec2 minus = max(vec2(0), middle - SIDE_SINE * across);
  vec2 both = plus + minus;
  return vec4(front + SIDE_SOLID_ANGLE * (both.x + both.y), front, SIDE_SOLID_ANGLE * (plus - minus));
}

// Flux towards the six neighbours: x: +x and −x, y and z likewise.
struct Sent {
  vec2 x, y, z;
};
Sent sent_to_neighbours(vec4 s) {
  return Sent(vec2(sent(s.x, s.y, s.zw).x, sent(s.x, -s.y, s.zw).x),
              vec2(sent(s.x, s.z, s.yw).x, sent(s.x, -s.z, s.yw).x),
              vec2(sent(s.x, s.w, s.yz).x, sent(s.x, -s.w, s.yz).x));
}

// Two bands ring below zero. Clamping alone would add energy (13.8 % for a cosine lobe), so that what is sent is scaled
// back to the unclamped total, 4π·m: v cancels over all 30 faces. Scales `sent` too.
vec4 keep_flux(vec4 state, inout Sent sent) {
  float clamped = sent.x.x + sent.x.y + sent.y.x + sent.y.y + sent.z.x + sent.z.y;
  float factor = clamped > 0. ? max(0., 4. * pi * state.x) / clamped : 0.;
  sent = Sent(factor * sent.x, factor * sent.y, factor * sent.z);
  return factor * state;
}

// Shares of a face are stored in 16 bits with the unit 2⁻¹⁵, so that 0, ½ and 1 are exact.
uint pack_shares(vec2 shares) {
  uvec2 fixed_point = uvec2(clamp(shares, 0., 1.) * 32768. + .5);
  return fixed_point.x | fixed_point.y << 16;
}
vec2 unpack_shares(uint bits) { return vec2(bits & 0xffffu, bits >> 16) / 32768.; }
