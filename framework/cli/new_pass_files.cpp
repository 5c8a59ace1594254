#include "cli/new_pass_files.h"

#include <string_view>

namespace loom::cli {
namespace {

// @Type@ and @snake@ stand for the names.
constexpr std::string_view source = R"text(// @Type@: what it computes, in one line.
//
//   image = sRGB(brightness · ⟨n, v⟩)
//
// State the equation and its source here, then the units of what goes in and out. This one shades every visible surface
// by the cosine between its normal n and the direction v towards the viewer.
#include <memory>

#include "loom/plugin.h"

namespace {

class @Type@ final : public loom::Pass {
 public:
  void params(loom::Params& p) override {
    p.real("brightness", brightness_, {.min = 0, .max = 4, .doc = "factor before the display curve"});
  }

  void reflect(loom::Ports& ports, const loom::SceneFacts& /*facts*/) override {
    ports.in("surface", "Surface").reads("depth").reads("normal");
    ports.out("image", "Image")
        .attribute("quantity", std::string("display"))
        .texture("image", loom::TextureDesc::image(ports.frame_size(), loom::Format::rgba16f),
                 loom::Access::image_write);
  }

  void prepare(loom::Device& device, const loom::Bindings& /*bindings*/) override {
    program_ = device.program({.files = {"@snake@/@snake@.comp"}, .defines = {}});
  }

  void execute(loom::Frame& frame, const loom::Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  float brightness_ = 1;
  std::shared_ptr<const loom::Program> program_;
};

}  // namespace

LOOM_PLUGIN("@snake@", registry) { registry.add<@Type@>("@Type@", "What it computes, in one line"); }
)text";

constexpr std::string_view shader =
    R"text(// Names say what is bound: <port>_<member> textures and images, <port>_data structs, parameters by their own names.
#include "interop/camera.h"
#include "lib/camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;   // metres along the ray, 0 where nothing is seen
uniform sampler2D surface_normal;  // unit, world, towards the viewer
uniform float brightness;
layout(rgba16f) uniform writeonly image2D image_image;

vec3 srgb(vec3 v) { return mix(12.92 * v, 1.055 * pow(v, vec3(1. / 2.4)) - .055, greaterThan(v, vec3(.0031308))); }

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(image_image)))) return;
  float cosine = 0.;
  if (texelFetch(surface_depth, pixel, 0).r > 0.) {
    vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    cosine = max(0., dot(n, -ray_direction(camera, pixel_uv(camera, pixel))));
  }
  imageStore(image_image, pixel, vec4(srgb(clamp(vec3(brightness * cosine), 0., 1.)), 1.));
}
)text";

constexpr std::string_view build = R"text(cmake_minimum_required(VERSION 3.25)
project(@snake@ LANGUAGES CXX)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# The prefix that Lightloom is installed in, where it is not a usual one: -DCMAKE_PREFIX_PATH=<prefix>
find_package(Loom REQUIRED)
loom_add_pass()
)text";

constexpr std::string_view pipeline = R"text({
  "name": "@snake@",
  "summary": "@Type@ on its own",
  "passes": {
    "gbuffer": { "type": "GBuffer" },
    "@snake@": { "type": "@Type@", "in": { "surface": "gbuffer.surface" }, "params": { "brightness": 1 } }
  },
  "outputs": { "image": "@snake@.image" }
}
)text";

constexpr std::string_view readme = R"text(# @Type@

A pass for Lightloom.

```
cmake -S . -B build        # -DCMAKE_PREFIX_PATH=<prefix> where Lightloom is not in a usual place
cmake --build build
loom render -p @snake@.json --plugins build -o out.png
```

| file | |
|---|---|
| `@snake@.cpp` | the pass: parameters, ports, execution |
| `shaders/@snake@/@snake@.comp` | its GLSL; a change needs no build |
| `@snake@.json` | a pipeline that shows it |

`loom passes @Type@ --plugins build` shows its ports and parameters, `--set @snake@.brightness=2` sets one.
)text";

std::string filled(std::string_view text, const PassNames& names) {
  std::string result(text);
  const auto replace = [&result](std::string_view mark, const std::string& name) {
    for (std::size_t at = result.find(mark); at != std::string::npos; at = result.find(mark, at + name.size())) {
      result.replace(at, mark.size(), name);
    }
  };
  replace("@Type@", names.type);
  replace("@snake@", names.snake);
  return result;
}

}  // namespace

std::map<std::string, std::string> new_pass_files(const PassNames& names) {
  return {{names.snake + ".cpp", filled(source, names)},
          {"CMakeLists.txt", filled(build, names)},
          {"shaders/" + names.snake + "/" + names.snake + ".comp", filled(shader, names)},
          {names.snake + ".json", filled(pipeline, names)},
          {"README.md", filled(readme, names)}};
}

}  // namespace loom::cli
