#include "graph/fakes.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <gtest/gtest.h>

namespace loom::test {
namespace {

constexpr auto image_format = Format::rgba16f;

TextureDesc frame_image(const Ports& ports) { return TextureDesc::image(ports.frame_size(), image_format); }

/// A pass with every kind of parameter.
class Tuned : public Pass {
 public:
  void params(Params& params) override {
    params.integer("iterations", iterations_, {.min = 1, .max = 64, .cost = Cost::graph, .doc = "how often"});
    params.real("radius", radius_, {.min = 0.01, .max = 100, .unit = "m", .scale = Scale::log, .doc = "how far"});
    params.boolean("exact", exact_, {.doc = "or fast"});
    params.choice("basis", basis_, {"sh", "sg"}, {.doc = "how encoded"});
    params.text("label", label_, {.doc = "any text"});
    params.colour("tint", tint_, {.min = 0, .max = 1, .doc = "linear"});
  }
  void reflect(Ports& ports, const SceneFacts& /*facts*/) override {
    ports.in("image", "Image").reads("image");
    ports.out("image", "Image").texture("image", frame_image(ports), Access::image_write);
  }
  void execute(Frame& /*frame*/, const Bindings& /*bindings*/) override {}

 private:
  int iterations_ = 16;
  float radius_ = 0.7F;
  bool exact_ = false;
  std::string basis_ = "sh";
  std::string label_ = "none";
  glm::vec3 tint_{1};
};

/// A pass with keys of its own.
class Scripted : public Pass {
 public:
  [[nodiscard]] std::span<const std::string_view> own_keys() const override {
    static constexpr std::array<std::string_view, 2> keys = {"file", "ports"};
    return keys;
  }
  void configure(const json::Node& object, Diagnostics& diagnostics) override {
    const auto* file = object.find("file");
    if (file == nullptr) diagnostics.error("shader-file", "a Scripted pass names its `file`", object.where);
  }
  void reflect(Ports& ports, const SceneFacts& /*facts*/) override {
    ports.out("image", "Image").texture("image", frame_image(ports), Access::image_write);
  }
  void execute(Frame& /*frame*/, const Bindings& /*bindings*/) override {}
};

class ThrowsInParams : public Pass {
 public:
  void params(Params& params) override { params.integer("n", n_, {.min = 1, .max = 2}); }
  void reflect(Ports& /*ports*/, const SceneFacts& /*facts*/) override {}
  void execute(Frame& /*frame*/, const Bindings& /*bindings*/) override {}

 private:
  int n_ = 3;
};

void geometry(Ports& ports, const SceneFacts& facts) {
  const auto size = ports.frame_size();
  auto surface = ports.out("surface", "Surface");
  surface.texture("depth", TextureDesc::image(size, Format::r32f), Access::color)
      .texture("normal", TextureDesc::image(size, image_format), Access::color)
      .texture("albedo", TextureDesc::image(size, Format::rgba8), Access::color);
  if (facts.emissive_triangles > 0 || !ports.rule("no-emission"))
    surface.texture("emission", TextureDesc::image(size, image_format), Access::color);
  else
    ports.decide("no-emission", "`emission` is not made", "0 emissive triangles");
  ports.scratch("depth", TextureDesc::image(size, Format::depth32f), Access::depth);
}

void lights(Ports& ports, const SceneFacts& facts) {
  auto out = ports.out("lights", "LightLayers");
  if (facts.light_faces() == 0) {
    out.absent("the scene has no punctual light");
    return;
  }
  const glm::ivec2 size{64, 64};
  out.texture("flux", TextureDesc::layers(size, facts.light_faces(), image_format), Access::color)
      .texture("depth", TextureDesc::layers(size, facts.light_faces(), Format::r32f), Access::color)
      .buffer("faces", {.bytes = 128});
  ports.keep_outputs();
}

void shade(Ports& ports, const SceneFacts&) {
  ports.in("surface", "Surface").reads("depth").reads("normal");
  auto light = ports.in("lights", "LightLayers").reads("flux", Access::image_read).reads("faces");
  auto out = ports.out("irradiance", "Irradiance");
  if (light.absent())
    out.absent("no light: " + light.why_absent());
  else
    out.texture("irradiance", frame_image(ports), Access::image_write);
}

void filter(Ports& ports, const SceneFacts&) {
  ports.in("image", "Image").reads("image");
  ports.out("image", "Image").texture("image", frame_image(ports), Access::image_write);
}

void volume(Ports& ports, const SceneFacts&) {
  ports.in("previous", "ShVolume").optional().reads("red");
  ports.out("volume", "ShVolume")
      .texture("red", TextureDesc::volume(32, image_format), Access::image_read_write)
      .texture("green", TextureDesc::volume(32, image_format), Access::image_read_write)
      .cleared("red");
}

void accumulate(Ports& ports, const SceneFacts&) {
  ports.in("image", "Image").reads("image");
  auto last = ports.in("last", "Image").optional().reads("image");
  auto out = ports.out("image", "Image");
  out.texture("image", last.texture("image") != nullptr ? *last.texture("image") : frame_image(ports),
              Access::image_write)
      .initial("image", glm::vec4(0.5F));
  ports.persistent("count", TextureDesc::image(ports.frame_size(), Format::r32ui), Access::image_read_write);
}

void add_types(Registry& registry) {
  const auto source = [](Ports& ports, const SceneFacts&) {
    ports.out("image", "Image")
        .texture("image", frame_image(ports), Access::color)
        .attribute("quantity", std::string("radiance"));
  };
  add(registry, "Geometry", geometry);
  add(registry, "Lights", lights);
  add(registry, "Shade", shade);
  add(registry, "Source", source);
  add(registry, "Filter", filter);
  add(registry, "Volume", volume);
  add(registry, "Accumulate", accumulate);
  add(registry, "Show", [](Ports& ports, const SceneFacts&) {
    ports.in("light", "Irradiance").reads("irradiance");
    ports.out("image", "Image").texture("image", frame_image(ports), Access::color);
  });
  add(registry, "Mix", [](Ports& ports, const SceneFacts&) {
    ports.in("a", "Image").reads("image");
    ports.in("b", "Image").reads("image");
    ports.out("image", "Image").texture("image", frame_image(ports), Access::image_write);
  });
  add(registry, "Pass", [](Ports& ports, const SceneFacts&) {
    ports.in("image", "Image");
    ports.out("image", "Image").forwards("image");
  });
  add(registry, "Brighten", [](Ports& ports, const SceneFacts&) {
    ports.in("image", "Image").reads("image", Access::image_read_write);
    ports.out("image", "Image").in_place("image");
  });
  add(registry, "Debug", [](Ports& ports, const SceneFacts&) {
    ports.in("any", "*").reads_all();
    ports.out("image", "Image").texture("image", frame_image(ports), Access::color);
  });
  add(registry, "Sink", [](Ports& ports, const SceneFacts&) {
    ports.in("image", "Image").reads("image");
    ports.side_effect();
  });
}

void add_broken_types(Registry& registry) {
  registry.add_pass({.name = "ThrowsWhenMade",
                     .create = []() -> std::unique_ptr<Pass> { throw std::runtime_error("no such device"); }});
  registry.add_pass({.name = "MakesNothing", .create = [] { return std::unique_ptr<Pass>(); }});
  add(registry, "ThrowsInReflect", [](Ports&, const SceneFacts&) { throw std::runtime_error("division by zero"); });
  add(registry, "Complains", [](Ports& ports, const SceneFacts&) {
    ports.out("image", "Image").texture("image", frame_image(ports), Access::color);
    ports.error("bands-differ", "two bands here, three there", "give both `bands`: 2");
  });
  add(registry, "ReadsWrongMember", [](Ports& ports, const SceneFacts&) {
    ports.in("surface", "Surface").reads("nrmal");
    ports.out("image", "Image").texture("image", frame_image(ports), Access::color);
  });
  add(registry, "MakesWrongMember", [](Ports& ports, const SceneFacts&) {
    ports.out("image", "Image").texture("picture", frame_image(ports), Access::color);
  });
  add(registry, "MakesBufferForTexture",
      [](Ports& ports, const SceneFacts&) { ports.out("image", "Image").buffer("image", {.bytes = 16}); });
  add(registry, "MakesUnknownBundle", [](Ports& ports, const SceneFacts&) { ports.out("image", "Imge"); });
  add(registry, "TooLarge", [](Ports& ports, const SceneFacts&) {
    ports.out("image", "Image").texture("image", TextureDesc::image({20000, 1}, image_format), Access::color);
  });
  add(registry, "WritesItsInput", [](Ports& ports, const SceneFacts&) {
    ports.in("image", "Image").reads("image", Access::image_write);
    ports.out("image", "Image").texture("image", frame_image(ports), Access::color);
  });
  add(registry, "DeclaresTwice", [](Ports& ports, const SceneFacts&) {
    ports.out("image", "Image").texture("image", frame_image(ports), Access::color);
    ports.out("image", "Image").texture("image", frame_image(ports), Access::color);
  });
  add(registry, "ForwardsNothing", [](Ports& ports, const SceneFacts&) { ports.out("image", "Image").forwards("in"); });
  add(registry, "MakesVpls",
      [](Ports& ports, const SceneFacts&) { ports.out("vpls", "VplSet").buffer("lights", {.bytes = 1024}); });
  add(registry, "NeverSettles", [](Ports& ports, const SceneFacts&) {
    auto last = ports.in("last", "Image").optional().reads("image");
    const int size = last.texture("image") != nullptr ? last.texture("image")->width + 1 : 1;
    ports.out("image", "Image").texture("image", TextureDesc::image({size, 1}, image_format), Access::color);
  });
}

}  // namespace

Registry fake_registry() {
  Registry registry;
  add_types(registry);
  registry.add<Tuned>("Tuned", "a fake with parameters");
  registry.add<Scripted>("Scripted", "a fake with keys of its own");
  registry.add<ThrowsInParams>("ThrowsInParams", "its default is outside its range");
  add_broken_types(registry);
  return registry;
}

SceneFacts one_light() {
  SceneFacts facts;
  facts.spot_lights = 1;
  facts.triangles = 12;
  return facts;
}

graph::CompileResult compile(const std::string& text, const Registry& registry, const graph::CompileOptions& options,
                             const SceneFacts& facts) {
  return graph::compile_text(text, "test.json", registry, facts, options);
}

std::string text_of(const Diagnostics& diagnostics) {
  std::string text;
  for (const auto& diagnostic : diagnostics.all()) text += to_string(diagnostic) + '\n';
  return text;
}

bool has_resource(const graph::CompiledGraph& graph, std::string_view name) {
  return std::any_of(graph.resources.begin(), graph.resources.end(), [&](const auto& r) { return r.name == name; });
}

const graph::Resource& resource(const graph::CompiledGraph& graph, std::string_view name) {
  for (const auto& candidate : graph.resources)
    if (candidate.name == name) return candidate;
  ADD_FAILURE() << "no resource " << name;
  static const graph::Resource nothing;
  return nothing;
}

std::string order_of(const graph::CompiledGraph& graph) {
  std::string text;
  for (const int pass : graph.order)
    text += (text.empty() ? "" : " ") + graph.passes[static_cast<std::size_t>(pass)].name;
  return text;
}

}  // namespace loom::test
