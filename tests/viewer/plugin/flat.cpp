// Flat: an image of one value, FLAT, which the build sets.
#include "loom/plugin.h"

namespace {

class Flat final : public loom::Pass {
 public:
  void reflect(loom::Ports& ports, const loom::SceneFacts&) override {
    ports.out("image", "Image")
        .texture("image", loom::TextureDesc::image(ports.frame_size(), loom::Format::rgba32f),
                 loom::Access::image_write)
        .attribute("quantity", "display");
  }
  void execute(loom::Frame&, const loom::Bindings& bindings) override {
    if (bindings.has("image.image")) bindings.texture("image.image").clear(glm::vec4(FLAT));
  }
};

}  // namespace

LOOM_PLUGIN("flat", registry) { registry.add<Flat>("Flat", "An image of one value"); }
