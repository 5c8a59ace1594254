layout(local_size_x = 8, local_size_y = 8) in;
// TextureKind
#define KIND_d2 0
#define KIND_d2_array 1
#define KIND_d3 2
#define KIND_cube 3
#define KIND_cube_array 4
uniform SAMPLER SOURCE;
uniform float range_min;
uniform float range_max;
uniform ivec2 layers;  // first, count
uniform ivec2 mosaic;  // columns, rows
layout(rgba16f) writeonly uniform image2D image_image;

vec3 channel_rgb(vec4 v) { return v.rgb; }
vec3 channel_r(vec4 v) { return v.rrr; }
vec3 channel_g(vec4 v) { return v.ggg; }
vec3 channel_b(vec4 v) { return v.bbb; }
vec3 channel_a(vec4 v) { return v.aaa; }
vec3 channel_luminance(vec4 v) { return vec3(dot(v.rgb, vec3(.2126, .7152, .0722))); }

// The texel of `layer` at the fraction p of its width and height, (0,0) bottom left.
vec4 texel(int layer, vec2 p) {
#if KIND == KIND_d2
  return vec4(texelFetch(SOURCE, ivec2(p * vec2(textureSize(SOURCE, 0))), 0));
#elif KIND == KIND_d2_array || KIND == KIND_d3
  return vec4(texelFetch(SOURCE, ivec3(p * vec2(textureSize(SOURCE, 0).xy), layer), 0));
#else
  vec2 q = 2 * (floor(p * vec2(textureSize(SOURCE, 0).xy)) + .5) / vec2(textureSize(SOURCE, 0).xy) - 1;
  int face = layer % 6;
  // The selection table of the OpenGL specification (8.13), inverted.
  vec3 direction = face == 0   ? vec3(1, -q.y, -q.x)
                   : face == 1 ? vec3(-1, -q.y, q.x)
                   : face == 2 ? vec3(q.x, 1, q.y)
                   : face == 3 ? vec3(q.x, -1, -q.y)
                   : face == 4 ? vec3(q.x, -q.y, 1)
                               : vec3(-q.x, -q.y, -1);
#if KIND == KIND_cube
  return vec4(textureLod(SOURCE, direction, 0));
#else
  return vec4(textureLod(SOURCE, vec4(direction, layer / 6), 0));
#endif
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  ivec2 size = imageSize(image_image);
  if (any(greaterThanEqual(pixel, size))) return;
  vec2 at = (vec2(pixel) + .5) / vec2(size) * vec2(mosaic);
  ivec2 cell = ivec2(at);
  int index = (mosaic.y - 1 - cell.y) * mosaic.x + cell.x;
  vec3 shown = vec3(0);
  if (index < layers.y) {
    vec3 value = CHANNEL(texel(layers.x + index, fract(at)));
    bool finite = !any(isnan(value)) && !any(isinf(value));
    shown = finite ? clamp((value - range_min) / (range_max - range_min), vec3(0), vec3(1)) : vec3(1, 0, 1);
  }
  imageStore(image_image, pixel, vec4(shown, 1));
}
