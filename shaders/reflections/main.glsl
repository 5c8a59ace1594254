// main(): the mean of radiance_at(pixel, depth) over the parts that the rays of a pixel are shared out over.
#if PARTS
layout(rgba32f) uniform image2D scratch_sum;
layout(rgba32f) uniform image2D scratch_ends;
#endif
#if RADIANCE
writeonly uniform image2D radiance_image;
#endif
#if ENDS
writeonly uniform image2D ends_image;
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(surface_depth, 0)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 radiance = depth > 0. ? radiance_at(pixel, depth) : vec3(0);
#if PARTS
  radiance /= float(part.y);
  if (part.x > 0) {
    radiance += imageLoad(scratch_sum, pixel).rgb;
    ray_ends += imageLoad(scratch_ends, pixel);
  }
  if (part.x + 1 < part.y) {
    imageStore(scratch_sum, pixel, vec4(radiance, 1));
    imageStore(scratch_ends, pixel, ray_ends);
    return;
  }
#endif
#if RADIANCE
  imageStore(radiance_image, pixel, vec4(radiance, 1));
#endif
#if ENDS
  imageStore(ends_image, pixel, vec4(ray_ends.xyz / max(ray_ends.w, 1.), 1));
#endif
}
