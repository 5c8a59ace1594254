// RSM: reflective shadow maps (Dachsbacher and Stamminger 2005), what each light sees, one layer a light face.
//
// Every texel is a small Lambertian emitter. With ρ the albedo, it reflects the flux
//   spot and point:  Φ = ρ·I(ω)·ω_texel   [W],  I in W/sr, ω_texel = (2t/N)²/(1+x²+y²)^1.5 in sr
//   directional:     Φ = ρ·E⊥·A_texel     [W],  E⊥ in W/m²
// and there is no cosine: it cancels with the area that the texel covers. So Φ/A = ρ·E(x) with the covered area
// A = r²·ω_texel/⟨n,−l⟩ (directional: A_texel/⟨n,−l⟩), and ΣΦ does not depend on the map's size.
//
// Beside flux, geometric normal and distance there is a depth map of its own size for shadows. All faces are drawn at
// once, as layers, by a geometry shader; what nobody reads is not drawn. A still scene is drawn once.
#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "interop/light.h"
#include "light_faces.h"
#include "loom/fingerprint.h"
#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

// What OpenGL 4.5 guarantees: MAX_GEOMETRY_SHADER_INVOCATIONS and MAX_ARRAY_TEXTURE_LAYERS.
constexpr int max_invocations = 32;
constexpr int max_layers = 2048;

class RSM final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("size", size_,
              {.min = 1,
               .max = 4096,
               .unit = "texels",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "side of the flux, normal and depth maps of a light face"});
    p.integer("shadow_size", shadow_size_,
              {.min = 1,
               .max = 8192,
               .unit = "texels",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "side of the shadow map of a light face"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto lights = ports.out("lights", "LightLayers");
    faces_ = facts.light_faces();
    if (faces_ == 0) return lights.absent("the scene has no punctual light");
    if (faces_ > max_layers) {
      ports.error(
          "too-many-lights",
          std::to_string(faces_) + " light faces, but a texture holds " + std::to_string(max_layers) + " layers",
          "a point light takes 6, a spot of at most 60° half-angle or a directional light 1");
      return;
    }
    const auto map = [&](Format format) { return TextureDesc::layers({size_, size_}, faces_, format); };
    const int channels = rules::channels(ports, facts);
    lights.texture("flux", map(Format::rgba32f).with_channels(channels), Access::color);
    lights.attribute("channels", channels);
    lights.texture("normal", map(Format::rgba16f), Access::color);
    lights.texture("depth", map(Format::r32f), Access::color);
    lights.texture("shadow", TextureDesc::layers({shadow_size_, shadow_size_}, faces_, Format::depth32f),
                   Access::depth);
    lights.buffer("faces", BufferDesc{face_bytes()});
    ports.scratch("depth", map(Format::depth32f), Access::depth);
    ports.scratch("faces", BufferDesc{face_bytes()});
    facts_ = facts;
    facts_.normal_maps = false;  // a virtual light's normal is the triangle's
    if (!facts.moves && ports.rule("static")) {
      ports.keep_outputs();
      ports.decide("static", "light layers are drawn once", "nothing in the scene moves");
    }
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const std::string invocations = std::to_string(std::min(faces_, max_invocations));
    std::vector<Define> targets;
    colors_.clear();
    for (const auto& [member, define] : {std::pair<std::string_view, const char*>{"lights.flux", "FLUX_LOCATION"},
                                         {"lights.normal", "NORMAL_LOCATION"},
                                         {"lights.depth", "DEPTH_LOCATION"}}) {
      if (!bindings.has(member)) continue;
      targets.emplace_back(define, std::to_string(colors_.size()));
      colors_.push_back(member);
    }
    // A discard costs the early depth test, so that what a mask cuts is drawn by a program of its own.
    SceneFacts opaque = facts_;
    opaque.alpha_mask = false;
    const auto programs = [&](const char* fragment, const SceneFacts& unmasked, std::span<const Define> outputs) {
      const auto program = [&](const SceneFacts& facts) {
        auto defines = scene_defines(facts);
        defines.emplace_back("INVOCATIONS", invocations);
        defines.insert(defines.end(), outputs.begin(), outputs.end());
        return device.program({.files = {"rsm/rsm.vert", "rsm/rsm.geom", fragment}, .defines = defines});
      };
      return Programs{program(unmasked), facts_.alpha_mask ? program(facts_) : nullptr};
    };
    if (!colors_.empty()) maps_ = programs("rsm/rsm.frag", opaque, targets);
    if (bindings.has("lights.shadow")) {
      opaque.textures = false;  // depth alone needs them only for what a mask cuts out
      shadow_ = programs("rsm/shadow.frag", opaque, {});
    }
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const SceneView& scene = frame.scene();
    const auto faces = rsm::light_faces(scene.lights(), scene.facts());
    if (static_cast<int>(faces.size()) != faces_) {
      throw Error("RSM: the scene has " + std::to_string(faces.size()) +
                  " light faces now, the graph was compiled for " + std::to_string(faces_) + "; compile it again");
    }
    bindings.buffer("scratch.faces").write(std::as_bytes(std::span(faces)));
    if (bindings.has("lights.faces")) bindings.buffer("lights.faces").write(std::as_bytes(std::span(faces)));
    bindings.publish("lights", interop::LightLayers{
                                   .count = {faces_, static_cast<int>(scene.lights().size()), size_, shadow_size_}});
    if (bindings.has("lights.shadow")) {
      static constexpr std::array<std::string_view, 1> members{"lights.shadow"};
      frame.begin_raster(bindings, members);
      draw(frame, bindings, shadow_);
    }
    if (!colors_.empty()) {
      auto members = colors_;
      members.emplace_back("scratch.depth");
      frame.begin_raster(bindings, members);
      draw(frame, bindings, maps_);
    }
  }

  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override { return scene_version(frame.scene()); }

 private:
  [[nodiscard]] std::size_t face_bytes() const { return static_cast<std::size_t>(faces_) * sizeof(interop::LightFace); }

  struct Programs {
    std::shared_ptr<const Program> opaque, masked;  ///< masked is null where nothing is
  };

  void draw(Frame& frame, const Bindings& bindings, const Programs& programs) const {
    draw(frame, bindings, *programs.opaque, Surfaces::opaque);
    if (programs.masked) draw(frame, bindings, *programs.masked, Surfaces::masked);
  }

  void draw(Frame& frame, const Bindings& bindings, const Program& program, Surfaces which) const {
    frame.bind(program, bindings);
    for (int first = 0; first < faces_; first += max_invocations) {
      program.set("first_face", first);
      program.set("face_count", faces_);
      program.set("map_size", size_);
      frame.scene().draw(program, 1, which);
    }
  }

  int size_ = 256;
  int shadow_size_ = 2048;
  int faces_ = 0;
  SceneFacts facts_;
  std::vector<std::string_view> colors_;
  Programs maps_, shadow_;
};

}  // namespace

LOOM_PLUGIN("rsm", registry) {
  registry.add<RSM>("RSM", "What each light sees: flux, normal, distance and shadow map");
}
