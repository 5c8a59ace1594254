// Reference: the path tracer as a pass (docs/reference.md). Every frame adds samples to all before it, until the scene,
// the camera or a parameter changes; so the outputs come nearer to the truth with every frame:
//
//   L = L_e + ρ/π·(E_direct + E_emitter + E_bounce),   indirect = emitter + bounce.
//
// The pixel filter is a box of one pixel, drawn inside the pass: it takes no notice of the frame's own sub-pixel shift.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/plugin.h"
#include "reference/film.h"
#include "reference/path_tracer.h"

namespace {

using namespace loom;

class Reference final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("samples", samples_,
              {.min = 1, .max = 4096, .scale = Scale::log, .doc = "samples a pixel that each frame adds"});
    p.integer("limit", limit_,
              {.min = 1, .max = 1 << 24, .scale = Scale::log, .doc = "samples a pixel after which the image rests"});
    p.integer(
        "bounces", bounces_,
        {.min = -1, .max = 1024, .doc = "reflections before the light arrives at the visible surface; -1: no limit"});
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    const TextureDesc desc = TextureDesc::image(ports.frame_size(), Format::rgba32f);
    ports.out("radiance", "Image").texture("image", desc, Access::image_write).attribute("quantity", "radiance");
    for (const Output& output : irradiances) {
      ports.out(output.port, "Irradiance")
          .texture("irradiance", desc, Access::image_write)
          .attribute("quantity", "irradiance");
    }
    // Outputs are uploaded, not drawn: storage of their own, so that no other pass's writes race with the upload.
    ports.keep_outputs();
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    follow(frame);
    const auto wanted = static_cast<std::uint32_t>(limit_);
    const std::uint32_t done = film_.least_count();
    const auto added = static_cast<std::uint32_t>(samples_);
    const std::uint32_t target = done >= wanted ? done : std::min(wanted, done + added);
    tracer_->accumulate(film_, reference::relative_to(origin_, camera_), target);
    upload(bindings, "radiance.image", reference::Layer::radiance);
    for (const Output& output : irradiances) upload(bindings, output.member, output.layer);
  }

 private:
  struct Output {
    std::string_view port, member;
    reference::Layer layer;
  };
  static constexpr Output irradiances[] = {
      {"direct", "direct.irradiance", reference::Layer::direct},
      {"emitter", "emitter.irradiance", reference::Layer::emitter},
      {"bounce", "bounce.irradiance", reference::Layer::bounce},
      {"indirect", "indirect.irradiance", reference::Layer::indirect},
  };

  /// What the accumulation is of.
  struct State {
    std::uint64_t geometry = 0, lights = 0;
    int bounces = 0;
    std::uint32_t seed = 0;
    glm::vec4 eye{0}, right{0}, up{0}, forward{0}, size{0};
    bool operator==(const State&) const = default;
  };

  /// Starts again where anything changed.
  void follow(const Frame& frame) {
    const SceneView& view = frame.scene();
    const scene::Scene* scene = view.cpu_scene();
    if (scene == nullptr) throw Error("the Reference pass needs a scene that is loaded on the CPU too");
    camera_ = frame.camera();
    const State state{.geometry = view.geometry_version(),
                      .lights = view.lights_version(),
                      .bounces = bounces_,
                      .seed = frame.info().seed,
                      .eye = camera_.eye,
                      .right = glm::vec4(glm::vec3(camera_.right), 0),
                      .up = glm::vec4(glm::vec3(camera_.up), 0),
                      .forward = camera_.forward,
                      .size = camera_.size};
    if (frame.info().index > 0 && tracer_ && state == state_) return;

    const bool moved_far = glm::distance(origin_, glm::dvec3(camera_.eye)) >
                           glm::distance(view.facts().bounds_min, view.facts().bounds_max);
    const reference::Options options{.bounces = bounces_, .seed = state.seed};
    if (!tracer_ || moved_far || scene != scene_ || state.geometry != state_.geometry ||
        state.lights != state_.lights || state.bounces != state_.bounces || state.seed != state_.seed) {
      origin_ = glm::dvec3(camera_.eye);
      tracer_.reset();  // the old scene's memory goes first
      tracer_.emplace(*scene, origin_, options);
    }
    scene_ = scene;
    state_ = state;
    film_ = reference::Film(frame.size(), {}, state.seed);
  }

  void upload(const Bindings& bindings, std::string_view member, reference::Layer layer) {
    if (!bindings.has(member)) return;
    const glm::ivec2 size = film_.size();
    texels_.clear();
    for (int y = size.y - 1; y >= 0; --y) {  // texture row 0 is the bottom
      for (int x = 0; x < size.x; ++x) {
        texels_.emplace_back(glm::vec3(reference::Film::mean(film_.pixel(x, y), layer)), 1.F);
      }
    }
    bindings.texture(member).write(std::as_bytes(std::span(texels_)));
  }

  int samples_ = 16;
  int limit_ = 1 << 24;
  int bounces_ = -1;
  std::optional<reference::PathTracer> tracer_;
  const scene::Scene* scene_ = nullptr;
  glm::dvec3 origin_{0};
  interop::Camera camera_{};
  State state_;
  reference::Film film_;
  std::vector<glm::vec4> texels_;
};

}  // namespace

LOOM_PLUGIN("reference", registry) {
  registry.add<Reference>("Reference", "The path-traced truth, better with every frame");
}
