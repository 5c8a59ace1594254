// VplShadowMaps: what the brightest virtual point lights see, as small maps of the hemisphere over each.
//
// A light of flux Φ has the radiant intensity Φ/π·cosθ over the half-space of its normal. Of all lights the `maps` of
// most flux (mean of the channels) get a layer each: the octahedral map of the hemisphere (Cigolle et al., JCGT 3(2),
// 2014), size² texels, of which each holds the surface that the ray through its middle meets: unit normal towards the
// light, and distance in metres (0: nothing). Rays against the BVH fill them, and not the rasteriser: this map bends
// straight edges, which rasterised triangles do not, and size² rays a light are fewer than triangles of a large scene.
// (Shadow maps for virtual lights: Dachsbacher and Stamminger 2006; Ritschel et al., "Imperfect Shadow Maps", 2008.)
//
// A light keeps its layer as long as it is chosen, and its map as long as it stays in its place and the geometry
// stands still: only maps of lights that were replaced are traced. `counts` holds: maps in use, maps traced in this
// frame, the share of all flux that the lights with a map have, lights.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <glm/vec4.hpp>

#include "interop/vpl.h"
#include "loom/plugin.h"

namespace {

using namespace loom;

class VplShadowMaps final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("maps", maps_,
              {.min = 1,
               .max = 2048,  // what OpenGL 4.5 guarantees of layers
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "lights that get a map, the brightest first"});
    p.integer("size", size_,
              {.min = 2,
               .max = 128,
               .unit = "texels",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "side of the map of a light's hemisphere"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto vpls = ports.in("vpls", "VplSet").reads("lights", Access::storage_read);
    auto shadows = ports.out("shadows", "VplShadows");
    auto counts = ports.out("counts", "Image");
    if (vpls.absent()) {
      shadows.absent(vpls.why_absent());
      return counts.absent(vpls.why_absent());
    }
    facts_ = facts;
    const int most = vpls.attribute("most", 1);
    layers_ = std::min(maps_, most);
    const auto of_each = [](int number, std::size_t bytes) {
      return BufferDesc{static_cast<std::size_t>(number) * bytes};
    };
    shadows.texture("maps", TextureDesc::layers({size_, size_}, layers_, Format::rgba32f), Access::image_write);
    shadows.buffer("of", of_each(most, sizeof(std::uint32_t)));
    shadows.needed("maps").needed("of");
    counts.texture("image", TextureDesc::image({1, 1}, Format::rgba32f), Access::image_write);
    counts.attribute("quantity", "maps, traced, share of flux, lights");
    ports.persistent("owners", of_each(layers_, 2 * sizeof(glm::vec4)));
    ports.persistent("places", of_each(most, sizeof(std::uint32_t)));
    ports.scratch("todo", of_each(layers_, sizeof(std::uint32_t)));
    ports.scratch("unused", of_each(layers_, sizeof(std::uint32_t)));
    ports.keep_outputs(Keep::parts);
  }

  void prepare(Device& device, const Bindings& bindings) override {
    select_ = device.program(
        {.files = {"vpl_shadow_maps/select.comp"}, .defines = {{"COUNTS", bindings.has("counts.image") ? "1" : "0"}}});
    trace_ = device.program({.files = {"vpl_shadow_maps/trace.comp"}, .defines = scene_defines(facts_)});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const std::uint64_t geometry = frame.scene().geometry_version();
    select_->set("layers", layers_);
    select_->set("all", bindings.kept() && geometry_ == geometry ? 0 : 1);
    geometry_ = geometry;
    bindings.publish("shadows", interop::VplShadows{.count = {size_, layers_, 0, 0}});
    frame.dispatch(*select_, bindings, {1, 1, 1});
    frame.barrier();
    frame.dispatch(*trace_, bindings, {size_, size_, layers_});
  }

  /// Lights come in over the wire.
  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override { return frame.scene().geometry_version(); }

 private:
  int maps_ = 256, size_ = 16, layers_ = 1;
  std::optional<std::uint64_t> geometry_;  ///< that the maps were traced in
  SceneFacts facts_;
  std::shared_ptr<const Program> select_, trace_;
};

}  // namespace

LOOM_PLUGIN("vpl_shadow_maps", registry) {
  registry.add<VplShadowMaps>("VplShadowMaps",
                              "What the brightest virtual point lights see, as small hemispherical maps");
}
