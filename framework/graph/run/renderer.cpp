#include "graph/run/renderer.h"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "gpu/context.h"
#include "gpu/debug.h"
#include "gpu/timer.h"
#include "graph/run/bindings.h"
#include "graph/run/finite.h"
#include "graph/run/frame.h"
#include "graph/run/gl_state.h"
#include "graph/run/keep.h"
#include "graph/run/statistics.h"
#include "graph/run/storage.h"
#include "graph/run/structs.h"
#include "loom/diagnostic.h"

namespace loom::graph {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

GLbitfield gl_barriers(unsigned barriers) {
  GLbitfield bits = 0;
  if (barriers & barrier_texture_fetch) bits |= GL_TEXTURE_FETCH_BARRIER_BIT;
  if (barriers & barrier_image_access) bits |= GL_SHADER_IMAGE_ACCESS_BARRIER_BIT;
  if (barriers & barrier_storage) bits |= GL_SHADER_STORAGE_BARRIER_BIT;
  if (barriers & barrier_framebuffer) bits |= GL_FRAMEBUFFER_BARRIER_BIT;
  if (barriers & barrier_update) bits |= GL_TEXTURE_UPDATE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT;
  return bits;
}

glm::ivec2 frame_size(const CompiledGraph& graph) {
  return graph.passes.empty() ? glm::ivec2(1) : graph.passes.front().ports.frame_size();
}

// Runs `work` of a pass; what goes wrong is told with the pass's name and place.
template <class Work>
void on_behalf(const CompiledPass& pass, std::string_view doing, const Work& work) {
  Diagnostics diagnostics;
  const std::string who = fmt::format("pass '{}' ({}) {}", pass.name, pass.type, doing);
  try {
    work();
    return;
  } catch (const BadInput&) {
    throw;
  } catch (const Error& error) {
    for (Diagnostic d : error.diagnostics().all()) {
      if (d.code != "bind") d.message = who + ": " + d.message;  // those name the pass themselves
      if (d.where.file.empty()) d.where = pass.where;
      diagnostics.add(std::move(d));
    }
  } catch (const std::exception& error) {
    diagnostics.error("pass-failed", fmt::format("{}: {}", who, error.what()), pass.where);
  }
  throw Error(std::move(diagnostics));
}

// What a driver could not do in the middle of a frame, it says once, here: the frame is not to be trusted.
void require_device() {
  Diagnostics diagnostics;
  if (glGetGraphicsResetStatus() != GL_NO_ERROR) {
    diagnostics.error("device-lost", "the graphics device was reset in the middle of a frame, and all it held is lost",
                      {}, "run it again; a driver may end a frame that takes seconds: a smaller --size is quicker");
  } else if (glGetError() == GL_OUT_OF_MEMORY) {
    diagnostics.error("device-memory", "the graphics device ran out of memory in the middle of a frame", {},
                      "a smaller image or grid needs less: see loom plan, and --max-memory");
  }
  if (diagnostics.has_errors()) throw Error(std::move(diagnostics));
}

class RendererImpl final : public Renderer {
 public:
  RendererImpl(CompiledGraph graph, Device& device, RendererOptions options)
      : graph_(std::move(graph)),
        device_(device),
        options_(options),
        storage_(graph_),
        structs_(graph_),
        frame_(graph_, storage_, structs_, frame_size(graph_)),
        keep_(graph_),
        timer_(graph_.order.size(), options.wait && gpu::is_software_device()),
        gpu_ms_(graph_.order.size()),
        cpu_ms_(graph_.order.size()) {
    for (const CompiledPass& pass : graph_.passes)
      bindings_.push_back(std::make_unique<PassBindings>(pass, graph_, storage_, structs_, keep_, history_valid_));
    find_producers();
    prepare_again();
  }

  void render(const SceneView& scene, const interop::Camera& camera, const FrameInfo& info) override {
    const auto wall_start = Clock::now();
    storage_.require_externals();
    {
      const SavedState saved;
      const gpu::DebugGroup group(graph_.name);
      // What the last frame, or the program, left in flight.
      glMemoryBarrier(GL_ALL_BARRIER_BITS);
      if (frames_since_reset_ > 0) {
        storage_.swap_history();
        structs_.swap_history();
      }
      history_valid_ = frames_since_reset_ > 0;
      frame_.begin_frame(scene, camera, info);
      kept_.clear();
      keep_.begin_frame();
      timer_.begin_frame();
      timer_.mark();
      for (std::size_t i = 0; i < graph_.order.size(); ++i) run_pass(i);
      glMemoryBarrier(GL_ALL_BARRIER_BITS);  // for whoever reads the outputs
    }
    ++frames_since_reset_;
    const auto cpu_end = Clock::now();
    if (options_.wait) {
      glFinish();
      require_device();
    }
    wall_ms_.add(milliseconds(Clock::now() - wall_start));
    frame_cpu_ms_.add(milliseconds(cpu_end - wall_start));
    collect_times(false);
  }

  void reset() override {
    storage_.reset();
    structs_.reset();
    keep_.forget();
    history_valid_ = false;
    frames_since_reset_ = 0;
  }

  bool adopt_state(const Renderer& other) override {
    const auto& from = static_cast<const RendererImpl&>(other);  // the only kind there is
    const Adopted textures = storage_.adopt(from.storage_);
    const Adopted structs = structs_.adopt(from.structs_);
    keep_.forget();
    // The valid flag is one for all history: where some of it is new, none of it counts.
    frames_since_reset_ = textures.history && structs.history ? from.frames_since_reset_ : 0;
    return textures.history && structs.history && textures.persistent;
  }

  [[nodiscard]] const Texture* resource(int index) const override { return storage_.texture(index); }
  [[nodiscard]] const Buffer* buffer(int index) const override { return storage_.buffer(index); }

  [[nodiscard]] std::span<const std::byte> bundle_data(int index) const override {
    const Bundle& bundle = graph_.bundles.at(static_cast<std::size_t>(index));
    return structs_.data(index, bundle.struct_bytes, bundle.name);
  }

  [[nodiscard]] const Texture* output(std::string_view name) const override {
    const GraphOutput& output = find_output(name);
    return output.resource == none ? nullptr : storage_.texture(output.resource);
  }

  [[nodiscard]] ReadImage read(std::string_view name) const override {
    const GraphOutput& output = find_output(name);
    const glm::ivec2 size = frame_size(graph_);
    ReadImage image{.width = size.x, .height = size.y, .quantity = output.quantity};
    if (output.resource == none) {
      image.texels.assign(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), glm::vec4(0));
      return image;
    }
    const Texture* texture = storage_.texture(output.resource);
    if (!texture) throw Error(fmt::format("output '{}' is a buffer, which cannot be read as an image", name));
    image.width = texture->desc().width;
    image.height = texture->desc().height;
    image.layers = texture->desc().depth;
    image.texels = texture->read();
    // OpenGL's row 0 is the bottom one.
    const auto width = static_cast<std::ptrdiff_t>(image.width);
    for (int layer = 0; layer < image.layers; ++layer) {
      const auto first = image.texels.begin() + layer * width * image.height;
      for (int row = 0; row < image.height / 2; ++row)
        std::swap_ranges(first + row * width, first + (row + 1) * width, first + (image.height - 1 - row) * width);
    }
    return image;
  }

  void set_input(std::string_view name, std::string_view member, GlName texture, const TextureDesc& desc) override {
    storage_.set_external(name, member, texture, desc);
    frame_.forget_framebuffers();
  }

  void set_input_data(std::string_view name, std::span<const std::byte> data) override {
    const std::string wanted = fmt::format("inputs.{}", name);
    for (std::size_t i = 0; i < graph_.bundles.size(); ++i)
      if (graph_.bundles[i].name == wanted && !graph_.bundles[i].history)
        return structs_.publish(static_cast<int>(i), data, wanted);
    throw BadInput({.code = "unknown-input", .message = fmt::format("the graph has no {}", wanted)});
  }

  ParamChange set_param(std::string_view name, std::string_view param, std::string_view text,
                        Diagnostics& diagnostics) override {
    const auto it =
        std::find_if(graph_.passes.begin(), graph_.passes.end(), [&](const auto& p) { return p.name == name; });
    if (it == graph_.passes.end()) {
      std::vector<std::string> names;
      for (const CompiledPass& pass : graph_.passes) names.push_back(pass.name);
      const std::string near = nearest_name(name, names);
      diagnostics.error("unknown-pass", fmt::format("no pass is called '{}'", name), {},
                        near.empty() ? "" : fmt::format("did you mean '{}'?", near));
      return ParamChange::refused;
    }
    const ParamDecl* decl = it->params.find(param);
    if (decl && decl->cost == Cost::graph) return ParamChange::needs_compile;
    const std::optional<ParamValue> old = decl ? std::optional(Params::value_of(*decl)) : std::nullopt;
    if (!it->params.set_text(param, text, it->name, diagnostics)) return ParamChange::refused;
    if (decl->cost == Cost::shader && it->runs) {
      try {
        prepare(static_cast<std::size_t>(it - graph_.passes.begin()));
      } catch (...) {
        restore(*decl, *old);
        prepare(static_cast<std::size_t>(it - graph_.passes.begin()));
        throw;
      }
    }
    return ParamChange::applied;
  }

  void prepare_again() override {
    gpu::require_current_context();
    const SavedState saved;
    for (const int pass : graph_.order) prepare(static_cast<std::size_t>(pass));
    keep_.forget();
  }

  [[nodiscard]] const CompiledGraph& graph() const override { return graph_; }

  [[nodiscard]] std::vector<PassTimes> pass_times() const override {
    collect_times(true);
    std::vector<PassTimes> times;
    for (std::size_t i = 0; i < graph_.order.size(); ++i) {
      const CompiledPass& pass = graph_.passes[static_cast<std::size_t>(graph_.order[i])];
      times.push_back({pass.name, pass.type, gpu_ms_[i].median(), gpu_ms_[i].quantile(.95), cpu_ms_[i].median()});
    }
    return times;
  }

  [[nodiscard]] std::vector<PassCost> newest_costs() const override {
    std::vector<PassCost> costs;
    for (std::size_t i = 0; i < graph_.order.size(); ++i)
      costs.push_back(
          {graph_.passes[static_cast<std::size_t>(graph_.order[i])].name, gpu_ms_[i].last(), cpu_ms_[i].last()});
    return costs;
  }

  [[nodiscard]] FrameTimes frame_times() const override {
    collect_times(true);
    return {wall_ms_.median(), frame_gpu_ms_.median(), frame_cpu_ms_.median(), frame_gpu_ms_.quantile(.95)};
  }

  [[nodiscard]] std::vector<FiniteReport> finite_reports() const override { return finite_; }
  [[nodiscard]] std::vector<std::string> kept_passes() const override { return kept_; }

 private:
  // Each resource is made by the first pass that has it as an output; in-place writers and forwarders come later.
  void find_producers() {
    begins_.resize(graph_.order.size());
    std::vector<bool> found(graph_.resources.size(), false);
    for (std::size_t i = 0; i < graph_.order.size(); ++i)
      for (const BoundPort& port : graph_.passes[static_cast<std::size_t>(graph_.order[i])].bound)
        for (const BoundMember& member : port.members) {
          if (port.is_input || member.resource == none || found[static_cast<std::size_t>(member.resource)]) continue;
          found[static_cast<std::size_t>(member.resource)] = true;
          const auto lifetime = graph_.resources[static_cast<std::size_t>(member.resource)].lifetime;
          if (lifetime != Resource::Lifetime::external && lifetime != Resource::Lifetime::persistent)
            begins_[i].push_back(member.resource);
        }
  }

  void prepare(std::size_t index) {
    CompiledPass& pass = graph_.passes[index];
    bindings_[index]->forget_plans();
    on_behalf(pass, "could not be prepared", [&] { pass.pass->prepare(device_, *bindings_[index]); });
  }

  static void restore(const ParamDecl& decl, const ParamValue& value) {
    std::visit([&](auto* target) { *target = std::get<std::remove_pointer_t<decltype(target)>>(value); }, decl.target);
  }

  void run_pass(std::size_t position) {
    const int index = graph_.order[position];
    CompiledPass& pass = graph_.passes[static_cast<std::size_t>(index)];
    PassBindings& bindings = *bindings_[static_cast<std::size_t>(index)];
    const auto start = Clock::now();
    if (const GLbitfield bits = gl_barriers(pass.barriers)) glMemoryBarrier(bits);
    if (options_.fingerprints && keep_.may_keep(index, frame_)) {
      kept_.push_back(pass.name);
    } else {
      const gpu::DebugGroup group(pass.name);
      if (options_.poison && !(pass.ports.renews_parts && bindings.kept())) poison(pass, position);
      for (const int resource : begins_[position]) {
        if (graph_.resources[static_cast<std::size_t>(resource)].clear_each_frame) storage_.clear(resource);
      }
      frame_.begin_pass();
      on_behalf(pass, "failed", [&] { pass.pass->execute(frame_, bindings); });
      keep_.ran(index);
    }
    cpu_ms_[position].add(milliseconds(Clock::now() - start));
    timer_.mark();
    if (options_.check_finite && (kept_.empty() || kept_.back() != pass.name))
      count_bad_numbers(graph_, pass, storage_, frame_.info().index, finite_);
  }

  // What the pass is about to make. What it takes over from others is as they left it.
  void poison(const CompiledPass& pass, std::size_t position) {
    for (const int resource : begins_[position]) storage_.poison(resource);
    for (const OutputDecl& output : pass.ports.outputs) {
      if (output.in_place || output.forwards || output.absent) continue;
      for (const BoundPort& port : pass.bound)
        if (!port.is_input && port.name == output.name && port.bundle != none) structs_.poison(port.bundle);
    }
  }

  void collect_times(bool wait) const {
    timer_.collect(wait, [this](std::span<const double> spans) {
      double total = 0;
      for (std::size_t i = 0; i < spans.size(); ++i) {
        gpu_ms_[i].add(spans[i]);
        total += spans[i];
      }
      frame_gpu_ms_.add(total);
    });
  }

  [[nodiscard]] const GraphOutput& find_output(std::string_view name) const {
    std::vector<std::string> names;
    for (const GraphOutput& output : graph_.outputs) {
      if (output.name == name) return output;
      names.push_back(output.name);
    }
    const std::string near = nearest_name(name, names);
    throw BadInput(
        {.code = "unknown-output",
         .message = fmt::format("'{}' is no output that was asked for when the graph was compiled", name),
         .hint = near.empty() ? "name it in CompileOptions::requested" : fmt::format("did you mean '{}'?", near)});
  }

  CompiledGraph graph_;
  Device& device_;
  RendererOptions options_;
  Storage storage_;
  BundleStructs structs_;
  FrameRunner frame_;
  KeepTracker keep_;
  std::vector<std::unique_ptr<PassBindings>> bindings_;  ///< by pass
  std::vector<std::vector<int>> begins_;                 ///< by position: resources that its pass makes
  bool history_valid_ = false;
  std::uint64_t frames_since_reset_ = 0;
  std::vector<std::string> kept_;
  std::vector<FiniteReport> finite_;
  mutable gpu::SpanTimer timer_;
  mutable std::vector<Samples> gpu_ms_;
  mutable Samples frame_gpu_ms_;
  std::vector<Samples> cpu_ms_;
  Samples wall_ms_, frame_cpu_ms_;
};

}  // namespace

std::unique_ptr<Renderer> Renderer::create(CompiledGraph graph, Device& device, RendererOptions options) {
  gpu::require_current_context();
  return std::make_unique<RendererImpl>(std::move(graph), device, options);
}

}  // namespace loom::graph
