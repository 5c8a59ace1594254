// Add: E = E_a + E_b, per pixel and channel.
//
// Joins the parts of indirect light that separate passes compute (`indirect = emitter + bounce`). Where one side
// carries nothing, the other goes on as it is; where both carry nothing, so does the sum.
#include <memory>

#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class Add final : public Pass {
 public:
  void reflect(Ports& ports, const SceneFacts&) override {
    const auto a = ports.in("a", "Irradiance").optional().reads("irradiance");
    const auto b = ports.in("b", "Irradiance").optional().reads("irradiance");
    auto sum = ports.out("irradiance", "Irradiance");
    if (a.absent() && b.absent()) {
      sum.absent(a.connected() ? a.why_absent() : b.connected() ? b.why_absent() : "neither a nor b is wired");
    } else if (a.absent()) {
      sum.forwards("b");
    } else if (b.absent()) {
      sum.forwards("a");
    } else {
      const int channels = rules::channels({a, b});
      sum.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                  Access::image_write);
      sum.attribute("channels", channels);
      sum.attribute("quantity", "irradiance");
    }
  }

  void prepare(Device& device, const Bindings&) override { program_ = device.program({.files = {"add/add.comp"}}); }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("add", registry) { registry.add<Add>("Add", "Sum of two irradiances"); }
