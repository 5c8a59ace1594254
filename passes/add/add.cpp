// Add: E = E_a + E_b, per pixel and channel; AddRadiance: the same for images of radiance.
//
// Joins the parts of indirect light that separate passes compute (`indirect = emitter + bounce`), or of what surfaces
// reflect specularly. Where one side carries nothing, the other goes on as it is; where both carry nothing, so does the
// sum.
#include <memory>
#include <string>

#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

/// What is added: its bundle type and member, and the name of the output.
struct Quantity {
  const char *bundle, *member, *name;
};
constexpr Quantity irradiance{"Irradiance", "irradiance", "irradiance"};
constexpr Quantity radiance{"Image", "image", "radiance"};

template <const Quantity& quantity>
class Sum final : public Pass {
 public:
  void reflect(Ports& ports, const SceneFacts&) override {
    const auto a = ports.in("a", quantity.bundle).optional().reads(quantity.member);
    const auto b = ports.in("b", quantity.bundle).optional().reads(quantity.member);
    auto sum = ports.out(quantity.name, quantity.bundle);
    if (a.absent() && b.absent()) {
      sum.absent(a.connected() ? a.why_absent() : b.connected() ? b.why_absent() : "neither a nor b is wired");
    } else if (a.absent()) {
      sum.forwards("b");
    } else if (b.absent()) {
      sum.forwards("a");
    } else {
      const int channels = rules::channels({a, b});
      sum.texture(quantity.member, TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                  Access::image_write);
      sum.attribute("channels", channels);
      sum.attribute("quantity", quantity.name);
    }
  }

  void prepare(Device& device, const Bindings&) override {
    const std::string member = quantity.member;
    program_ = device.program(
        {.files = {"add/add.comp"},
         .defines = {{"A", "a_" + member}, {"B", "b_" + member}, {"SUM", std::string(quantity.name) + "_" + member}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("add", registry) {
  registry.add<Sum<irradiance>>("Add", "Sum of two irradiances");
  registry.add<Sum<radiance>>("AddRadiance", "Sum of two images of radiance");
}
