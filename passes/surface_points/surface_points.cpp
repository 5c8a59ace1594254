// SurfacePoints: points of the scene's surfaces with position, normal, albedo and the area A that each stands for, as
// textures (geometry images), for passes that inject points into a volume. `from` says which points:
//   area      on the triangles themselves, as many in each as its share of all area ΣA; each stands for ΣA/N
//   vertices  the corners of every triangle, each for a third of it: exact in area, as fine as the mesh
//   sides     what orthographic views from the six sides of the scene's box see: A = A_texel/|⟨n,l⟩|
//   cube      what a cubemap at one point sees: A = r²·ω_texel/|⟨n,l⟩|
// The first two need no view: nothing hides from them. No triangle is rasterised; the views are traced through the BVH,
// which knows textures by their mean albedo.
//
// Where `lights` are wired, each point also carries the flux that it reflects straight from them, Φ = ρ·E·A, with
// shadows by their maps. The points of `area` and `vertices` then show either side of their triangle in turn, each for
// both: Φ = ρ·E·2A.
#include "loom/fingerprint.h"
#include "loom/plugin.h"
#include "loom/rules.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace {

using namespace loom;

// MAX_TEXTURE_SIZE of OpenGL 4.5 is at least 16384.
constexpr double most_vertices = 16384. * 16384.;

class SurfacePoints final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("from", from_, {"area", "vertices", "sides", "cube"},
             {.cost = Cost::graph,
              .doc = "points on the triangles by area, their vertices, or what the box's six sides or a cubemap see"});
    p.integer("size", size_,
              {.min = 1,
               .max = 2048,
               .unit = "texels",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "side of the geometry image, of each view's where there are six; vertices take what they need"});
    const auto share = [&](const char* name, float& target) {
      p.real(name, target, {.doc = "cubemap: where it stands, as a share of the scene's box along this axis"});
    };
    share("x", at_.x);
    share("y", at_.y);
    share("z", at_.z);
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto lights = ports.in("lights", "LightLayers").optional();
    lights.reads("shadow").reads("faces", Access::storage_read);
    auto points = ports.out("points", "GeometryImage");
    if (facts.triangles == 0) return points.absent("the scene has no triangle");
    lit_ = !lights.absent();
    if (lit_ && from_ == "sides") {
      ports.error("counted-twice", "several sides see one surface: its light would count more than once",
                  "unwire `lights`, or take points from area, vertices or cube");
    }
    const double corners = 3. * static_cast<double>(facts.triangles);
    if (from_ == "vertices" && corners > most_vertices) {
      ports.error("too-many-vertices", "the scene's vertices exceed a texture of 16384²", "take points from area");
    }
    const bool views = from_ == "sides" || from_ == "cube";
    side_ = from_ == "vertices" ? static_cast<int>(std::ceil(std::sqrt(corners))) : size_;
    layers_ = views ? 6 : 1;
    const auto map = [&](Format format) { return TextureDesc::layers({side_, side_}, layers_, format); };
    points.texture("position", map(Format::rgba32f), Access::image_write);
    points.texture("normal", map(Format::rgba16f), Access::image_write);
    const int channels = rules::channels(ports, facts);
    points.texture("albedo", map(Format::rgba16f).with_channels(channels), Access::image_write);
    if (lit_) points.texture("flux", map(Format::rgba32f).with_channels(channels), Access::image_write);
    points.attribute("channels", channels);
    points.attribute("buffers", from_ == "sides" ? 6 : 1);
    if (from_ == "area") ports.scratch("areas", BufferDesc{facts.triangles * sizeof(float)});
    defines_ = scene_defines(facts);
    low_ = glm::vec3(facts.bounds_min);
    high_ = glm::vec3(facts.bounds_max);
    if (!facts.moves && ports.rule("static")) {
      ports.keep_outputs();
      ports.decide("static", "points are taken once", "nothing in the scene moves");
    }
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    auto defines = defines_;
    defines.emplace_back("FROM", "FROM_" + from_);
    for (const char* member : {"position", "normal", "albedo", "flux"}) {
      defines.emplace_back("MAKE_" + std::string(member), flag(bindings.has("points." + std::string(member))));
    }
    defines.emplace_back("LIT", flag(lit_));
    take_ = device.program({.files = {"surface_points/take.comp"}, .defines = defines});
    if (from_ == "area") areas_ = device.program({.files = {"surface_points/areas.comp"}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    if (areas_) {
      frame.dispatch(*areas_, bindings, {1, 1, 1});
      frame.barrier();
    }
    take_->set("side", side_);
    take_->set("box_low", low_);
    take_->set("box_high", high_);
    take_->set("eye", low_ + at_ * (high_ - low_));
    frame.dispatch(*take_, bindings, {side_, side_, layers_});
  }

  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    return scene_version(frame.scene(), frame.info().seed);
  }

 private:
  std::string from_ = "area";
  int size_ = 256;
  glm::vec3 at_{.5F};
  bool lit_ = false;
  int side_ = 0, layers_ = 0;
  glm::vec3 low_{0}, high_{0};
  std::vector<Define> defines_;
  std::shared_ptr<const Program> areas_, take_;
};

}  // namespace

LOOM_PLUGIN("surface_points", registry) {
  registry.add<SurfacePoints>("SurfacePoints", "Points of the scene's surfaces, from the triangles or from views");
}
