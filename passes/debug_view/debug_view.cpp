// DebugView: any texture of any bundle as a picture, v = (value − range_min)/(range_max − range_min) per channel,
// clamped to [0,1] and shown as it is (no encoding). Layers of an array, slices of a volume and faces of a cube are
// laid out as a mosaic, row by row from the top left, each cell as large as the frame allows and every texel the
// nearest one. What is not finite shows magenta.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "loom/plugin.h"

namespace {

using namespace loom;

/// Declared here and not by the shader, since GLSL has one sampler type a kind of texture.
std::string sampler_type(const TextureDesc& desc) {
  std::string prefix;
  if (desc.format == Format::r32i)
    prefix = "i";
  else if (is_integer(desc.format))
    prefix = "u";
  switch (desc.kind) {
    case TextureKind::d2:
      return prefix + "sampler2D";
    case TextureKind::d2_array:
      return prefix + "sampler2DArray";
    case TextureKind::d3:
      return prefix + "sampler3D";
    case TextureKind::cube:
      return prefix + "samplerCube";
    case TextureKind::cube_array:
      return prefix + "samplerCubeArray";
  }
  return "sampler2D";
}

/// True for a texture that the type may carry and that a producer leaves out where the scene does not need it.
bool is_texture_of(std::string_view type, std::string_view member) {
  const auto& types = builtin_bundles();
  const auto it = std::ranges::find(types, type, &BundleType::name);
  const BundleMember* found = it == types.end() ? nullptr : it->find(member);
  return found != nullptr && found->kind == MemberKind::texture;
}

class DebugView final : public Pass {
 public:
  void params(Params& p) override {
    p.text("member", member_, {.doc = "member of the bundle; empty = its first"});
    p.choice("channel", channel_, {"rgb", "r", "g", "b", "a", "luminance"},
             {.cost = Cost::shader, .doc = "what is shown"});
    p.real("range_min", min_, {.min = -1e9, .max = 1e9, .doc = "shown black"});
    p.real("range_max", max_, {.min = -1e9, .max = 1e9, .doc = "shown white"});
    p.integer("first", first_, {.min = 0, .max = 16383, .cost = Cost::graph, .doc = "first layer, slice or face"});
    p.integer("count", count_, {.min = 0, .max = 16384, .cost = Cost::graph, .doc = "how many of them; 0 = all"});
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    auto source = ports.in("source", "*");
    auto image = ports.out("image", "Image");
    image.attribute("quantity", "display");
    if (source.absent()) return image.absent(source.why_absent());
    shown_ = member_;
    std::vector<std::string> textures;
    for (const auto& member : source.info()->members) {
      if (std::holds_alternative<TextureDesc>(member.desc)) textures.push_back(member.name);
    }
    if (shown_.empty() && !textures.empty()) shown_ = textures.front();
    if (std::ranges::find(textures, shown_) == textures.end()) {
      if (is_texture_of(source.info()->type, shown_)) return image.absent("the scene needs no `" + shown_ + "`");
      const auto near = nearest_name(shown_, textures);
      std::string made;
      for (const auto& name : textures) made += (made.empty() ? "" : ", ") + name;
      ports.error("debug-member", "no texture `" + shown_ + "` in this " + source.info()->type,
                  near.empty() ? "it has: " + made : "did you mean `" + near + "`?");
      return;
    }
    source.reads(shown_);
    desc_ = *source.texture(shown_);
    image.texture("image", TextureDesc::image(ports.frame_size(), Format::rgba16f), Access::image_write);
  }

  void prepare(Device& device, const Bindings&) override {
    program_ = device.program({.files = {"debug_view/debug_view.comp"},
                               .defines = {{"SOURCE", "source_" + shown_},
                                           {"SAMPLER", sampler_type(desc_)},
                                           {"KIND", std::to_string(static_cast<int>(desc_.kind))},
                                           {"CHANNEL", "channel_" + channel_}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const int layers = desc_.kind == TextureKind::d2 ? 1 : std::max(1, desc_.depth);
    const int first = std::min(first_, layers - 1);
    const int shown = count_ == 0 ? layers - first : std::min(count_, layers - first);
    const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(shown))));
    program_->set("layers", glm::ivec2(first, shown));
    program_->set("mosaic", glm::ivec2(columns, (shown + columns - 1) / columns));
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  std::string member_, shown_, channel_ = "rgb";
  float min_ = 0, max_ = 1;
  int first_ = 0, count_ = 0;
  TextureDesc desc_;
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("debug_view", registry) {
  registry.add<DebugView>("DebugView", "Any texture of a bundle as a picture; layers and slices as a mosaic");
}
