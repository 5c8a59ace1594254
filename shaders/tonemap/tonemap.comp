layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D hdr_image;
uniform float exposure;
layout(rgba16f) writeonly uniform image2D image_image;

vec3 curve_linear(vec3 x) { return x; }
vec3 curve_reinhard(vec3 x) { return x / (1 + x); }
vec3 curve_aces(vec3 x) { return x * (2.51 * x + .03) / (x * (2.43 * x + .59) + .14); }

vec3 srgb(vec3 v) {
  vec3 encoded = mix(12.92 * v, 1.055 * pow(v, vec3(1 / 2.4)) - .055, greaterThan(v, vec3(.0031308)));
  // 1.055 − .055 rounds to just below 1, and a store to half floats may cut that down by 2⁻¹¹ more.
  return mix(encoded, vec3(1), greaterThanEqual(v, vec3(1)));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(image_image)))) return;
  vec3 radiance = texelFetch(hdr_image, pixel, 0).rgb;
  vec3 shown = vec3(1, 0, 1);
  if (!any(isnan(radiance))) {
    // Below 1e18 the square inside the curves cannot overflow; every bounded curve is flat long before that.
    vec3 x = clamp(radiance, vec3(0), vec3(1e18)) * exp2(exposure);
    shown = srgb(clamp(CURVE(min(x, vec3(1e18))), vec3(0), vec3(1)));
  }
  imageStore(image_image, pixel, vec4(shown, 1));
}
