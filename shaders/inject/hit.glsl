// Where a ray of emitted light met a surface.
struct EmissionHit {
  vec4 position;  // xyz: world, metres
  vec4 normal;    // xyz: unit, towards the light; w: 1 where the ray met anything
  vec4 flux;      // rgb: reflected, W
};
