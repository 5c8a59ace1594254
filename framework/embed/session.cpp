#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "core/data_dir.h"
#include "gpu/context.h"
#include "gpu/device.h"
#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "loom/lightloom.h"
#include "loom/registry.h"
#include "plugins/loader.h"
#include "reference/analysis.h"
#include "scene/gpu_scene.h"
#include "scene/load.h"
#include "scene/world.h"

namespace loom {
namespace {

constexpr glm::ivec2 default_size{512, 512};

[[noreturn]] void misuse(const char* what) {
  throw BadInput({.code = "session", .message = what, .hint = "call open(), load_scene(), load_pipeline(), render()"});
}

graph::Override override_of(const std::string& path, const std::string& value) {
  const auto dot = path.find('.');
  if (dot == std::string::npos)
    throw BadInput({.code = "usage", .message = fmt::format("'{}' is not of the form pass.param", path)});
  return {path.substr(0, dot), path.substr(dot + 1), value};
}

// A shipped pipeline goes by its name; everything else is a path.
std::string pipeline_path(const std::string& name) {
  std::error_code error;
  if (std::filesystem::exists(name, error)) return name;
  const auto shipped = std::filesystem::path(data_dir()) / "pipelines" / (name + ".json");
  return std::filesystem::exists(shipped, error) ? shipped.string() : name;
}

}  // namespace

struct Session::State {
  // In order of construction; destroyed backwards, so that GL objects go while their context is there and passes while
  // their plugins are loaded.
  std::optional<gpu::Context> context;
  Registry registry;
  Diagnostics diagnostics;
  std::unique_ptr<gpu::CachingDevice> device;
  std::unique_ptr<scene::Setup> setup;  ///< the GPU scene points into it
  scene::Box box;
  SceneFacts facts;
  std::unique_ptr<scene::GpuScene> gpu_scene;
  std::optional<View> view;
  std::string pipeline;
  PipelineOptions options;
  std::vector<graph::Override> overrides;
  std::unique_ptr<graph::Renderer> renderer;
  glm::ivec2 size{0};
  std::uint64_t frame = 0;
  double last_time_s = 0;

  [[nodiscard]] graph::Renderer& running() const {
    if (!renderer) misuse("no pipeline is loaded");
    return *renderer;
  }

  void compile() {
    graph::CompileOptions compile_options{.frame_size = size, .overrides = overrides, .requested = options.outputs};
    for (const ExternalInput& input : options.inputs) {
      BundleInfo& info = compile_options.external_inputs[input.input];
      info.type = input.type;
      info.members.push_back({.name = input.member, .desc = input.desc});
    }
    graph::CompileResult result = pipeline.starts_with('{')
                                      ? graph::compile_text(pipeline, "pipeline", registry, facts, compile_options)
                                      : graph::compile_file(pipeline, registry, facts, compile_options);
    if (!result.graph) throw BadInput(result.diagnostics);
    diagnostics.append(result.diagnostics);
    renderer.reset();  // its textures go before the new ones come
    // A program has its own frame loop, which waits for the GPU where it wants to.
    renderer = graph::Renderer::create(std::move(*result.graph), *device, {.wait = false});
    frame = 0;
  }

  [[nodiscard]] scene::Camera camera() const {
    scene::Camera camera = setup->camera;
    if (setup->camera_index >= 0) camera = setup->scene.cameras[static_cast<std::size_t>(setup->camera_index)];
    if (view) {
      const glm::dvec3& origin = setup->scene.origin;
      camera = {.eye = glm::dvec3(view->eye) - origin, .target = glm::dvec3(view->target) - origin, .up = view->up};
      camera.yfov_rad = view->yfov_rad;
    }
    return camera;
  }
};

Session::Session(std::unique_ptr<State> state) : state_(std::move(state)) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

Session Session::open(SessionOptions options) {
  auto state = std::make_unique<State>();
  if (options.own_context) state->context = gpu::Context::headless();
  gpu::require_current_context();
  const plugins::SearchPath search{.dirs = options.plugin_dirs};
  plugins::load_plugins(search, state->registry, state->diagnostics);
  std::vector<std::string> roots = std::move(options.shader_dirs);
  for (std::string& root : plugins::shader_roots(search)) roots.push_back(std::move(root));
  state->device = gpu::CachingDevice::create({.shader_roots = std::move(roots), .cache_dir = options.cache_dir});
  return Session(std::move(state));
}

void Session::load_scene(const std::string& path) {
  State& s = *state_;
  auto setup = std::make_unique<scene::Setup>(scene::load_setup(path, "", s.diagnostics));
  s.renderer.reset();
  s.gpu_scene.reset();
  s.setup = std::move(setup);
  s.box = scene::world_box(s.setup->scene);
  s.facts = scene::compute_facts(s.setup->scene);
  s.facts.measured = reference::cached_measurements(s.facts.content_hash);
  s.gpu_scene = scene::GpuScene::create(s.setup->scene);
  s.view.reset();
}

void Session::load_pipeline(const std::string& pipeline, PipelineOptions options) {
  State& s = *state_;
  if (!s.setup) misuse("a pipeline is compiled for a scene, and none is loaded");
  std::vector<graph::Override> overrides;
  for (const auto& [path, value] : s.setup->set) overrides.push_back(override_of(path, value));
  for (const auto& [path, value] : options.set) overrides.push_back(override_of(path, value));
  const std::string& wanted = pipeline.empty() ? s.setup->pipeline : pipeline;
  if (wanted.empty()) misuse("no pipeline is named, and the scene's run file names none");
  s.pipeline = wanted.starts_with('{') ? wanted : pipeline_path(wanted);
  s.size = options.size.x > 0 && options.size.y > 0 ? options.size : s.setup->size.value_or(default_size);
  s.overrides = std::move(overrides);
  s.options = std::move(options);
  s.compile();
}

void Session::resize(glm::ivec2 size) {
  (void)state_->running();
  state_->size = size;
  state_->compile();
}

void Session::set(const std::string& path, const std::string& value) {
  State& s = *state_;
  const graph::Override change = override_of(path, value);
  Diagnostics refused;
  switch (s.running().set_param(change.pass, change.param, value, refused)) {
    case graph::ParamChange::refused:
      throw BadInput(refused);
    case graph::ParamChange::applied:
      s.overrides.push_back(change);
      return;
    case graph::ParamChange::needs_compile:
      break;
  }
  s.overrides.push_back(change);
  try {
    s.compile();
  } catch (...) {
    s.overrides.pop_back();
    throw;
  }
}

void Session::set_view(const View& view) { state_->view = view; }

void Session::set_input(std::string_view input, std::string_view member, GlName texture, const TextureDesc& desc) {
  state_->running().set_input(input, member, texture, desc);
}

void Session::set_input_data(std::string_view input, std::span<const std::byte> data) {
  state_->running().set_input_data(input, data);
}

void Session::render(double time_s, std::uint32_t seed) {
  State& s = *state_;
  graph::Renderer& renderer = s.running();
  if (scene::pose(s.setup->scene, time_s)) {
    s.gpu_scene->update();
    s.box = scene::world_box(s.setup->scene);
  }
  const FrameInfo info{
      .index = s.frame, .time_s = time_s, .dt_s = s.frame == 0 ? 0 : time_s - s.last_time_s, .seed = seed};
  renderer.render(*s.gpu_scene, scene::make_camera(s.camera(), s.box, s.size), info);
  ++s.frame;
  s.last_time_s = time_s;
}

void Session::reset() {
  state_->running().reset();
  state_->frame = 0;
}

OutputTexture Session::output(std::string_view name) const {
  const graph::Renderer& renderer = state_->running();
  OutputTexture result;
  if (const Texture* texture = renderer.output(name)) {
    result.texture = texture->name();
    result.desc = texture->desc();
  }
  for (const graph::GraphOutput& output : renderer.graph().outputs)
    if (output.name == name) result.quantity = output.quantity;
  return result;
}

std::vector<glm::vec4> Session::read(std::string_view name) const { return state_->running().read(name).texels; }
glm::ivec2 Session::size() const { return state_->size; }
double Session::gpu_ms() const { return state_->running().frame_times().gpu_median_ms; }
const Diagnostics& Session::diagnostics() const { return state_->diagnostics; }

}  // namespace loom
