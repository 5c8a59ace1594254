layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D A;
uniform sampler2D B;
writeonly uniform image2D SUM;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(SUM)))) return;
  vec3 sum = texelFetch(A, pixel, 0).rgb + texelFetch(B, pixel, 0).rgb;
  imageStore(SUM, pixel, vec4(sum, 1));
}
