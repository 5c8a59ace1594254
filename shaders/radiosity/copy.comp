// One volume by sides of sheets to another.
layout(local_size_x = 32) in;
uniform sampler3D SOURCE;
writeonly uniform image3D TARGET;

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, textureSize(SOURCE, 0)))) return;
  imageStore(TARGET, texel, texelFetch(SOURCE, texel, 0));
}
