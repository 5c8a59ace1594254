layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D a_irradiance;
uniform sampler2D b_irradiance;
writeonly uniform image2D irradiance_irradiance;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  vec3 sum = texelFetch(a_irradiance, pixel, 0).rgb + texelFetch(b_irradiance, pixel, 0).rgb;
  imageStore(irradiance_irradiance, pixel, vec4(sum, 1));
}
