#include "viewer/live_pipeline.h"

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include <fmt/core.h>

namespace loom::viewer {
namespace {

/// A parameter can ask for any grid; a plan beyond this is refused before the machine has to swap for it.
constexpr std::size_t memory_limit = std::size_t{4} << 30;

std::vector<graph::Override> overrides_of(const Settings& set) {
  std::vector<graph::Override> overrides;
  for (const auto& [path, value] : set) {
    const std::size_t dot = path.find('.');
    overrides.push_back({path.substr(0, dot), dot == std::string::npos ? "" : path.substr(dot + 1), value});
  }
  return overrides;
}

Diagnostics one(std::string code, std::string message) {
  Diagnostics diagnostics;
  diagnostics.error(std::move(code), std::move(message));
  return diagnostics;
}

}  // namespace

template <class Work>
bool LivePipeline::attempt(const Work& work) {
  try {
    work();
    error_ = {};
    return true;
  } catch (const Error& error) {
    error_ = error.diagnostics();
  } catch (const std::bad_alloc&) {
    error_ = one("out-of-memory", "out of memory");
  } catch (const std::exception& error) {
    error_ = one("failed", error.what());
  }
  return false;
}

void LivePipeline::build(const PipelineRequest& request, const Surroundings& surroundings) {
  const auto compile = [&](const graph::CompileOptions& options) {
    graph::CompileResult result = graph::compile_file(request.path, surroundings.registry, surroundings.facts, options);
    if (!result.graph) throw BadInput(result.diagnostics);
    warnings_ = result.diagnostics;
    return std::move(*result.graph);
  };
  graph::CompileOptions options{.frame_size = request.size, .request_buffers = true};
  const graph::CompiledGraph plain = compile(options);
  files_ = plain.files;
  options.overrides = overrides_of(request.set);
  graph::CompiledGraph graph = compile(options);
  if (!request.inspect.empty()) {
    for (const graph::GraphOutput& output : graph.outputs) options.requested.push_back(output.name);
    options.requested.insert(options.requested.end(), request.inspect.begin(), request.inspect.end());
    graph = compile(options);
  }
  if (graph.bytes > memory_limit) {
    throw BadInput({.code = "over-memory",
                    .message = fmt::format("the plan takes {} MiB of textures and buffers, the inspector allows {}",
                                           graph.bytes >> 20, memory_limit >> 20),
                    .hint = "a smaller window or grid takes less"});
  }
  auto renderer = graph::Renderer::create(std::move(graph), surroundings.device);
  if (renderer_ && request.path == request_.path) renderer->adopt_state(*renderer_);
  renderer_ = std::move(renderer);
  request_ = request;
  broken_ = false;
  in_file_.clear();
  for (const graph::CompiledPass& pass : plain.passes)
    for (const ParamDecl& decl : pass.params.all())
      in_file_.emplace(pass.name + "." + decl.name, Params::value_of(decl));
}

bool LivePipeline::compile(const PipelineRequest& request, const Surroundings& surroundings) {
  return attempt([&] {
    if (std::find(files_.begin(), files_.end(), request.path) == files_.end()) files_ = {request.path};
    build(request, surroundings);
  });
}

bool LivePipeline::set_param(const std::string& pass, const std::string& param, const std::string& text,
                             const Surroundings& surroundings) {
  return attempt([&] {
    if (!renderer_) throw Error("no pipeline is running");
    PipelineRequest changed = request_;
    changed.set[pass + "." + param] = text;
    Diagnostics refused;
    switch (renderer_->set_param(pass, param, text, refused)) {
      case graph::ParamChange::refused:
        throw BadInput(refused);
      case graph::ParamChange::needs_compile:
        return build(changed, surroundings);
      case graph::ParamChange::applied:
        request_ = std::move(changed);
    }
  });
}

bool LivePipeline::render(const scene::GpuScene& scene, const interop::Camera& camera, const FrameInfo& info) {
  broken_ = !attempt([&] { renderer_->render(scene, camera, info); });
  return !broken_;
}

bool LivePipeline::prepare_again() {
  if (!renderer_) return true;
  broken_ = !attempt([&] { renderer_->prepare_again(); });
  return !broken_;
}

void LivePipeline::adopt(const LivePipeline& other) {
  if (renderer_ && other.renderer_ && request_.path == other.request_.path) renderer_->adopt_state(*other.renderer_);
}

void LivePipeline::reset() {
  if (renderer_) renderer_->reset();
}

bool LivePipeline::has_state() const {
  const auto outlives = [](const graph::Resource& resource) {
    return resource.lifetime == graph::Resource::Lifetime::history ||
           resource.lifetime == graph::Resource::Lifetime::persistent;
  };
  // The path tracer adds up on the CPU.
  const auto traces = [](const graph::CompiledPass& pass) { return pass.runs && pass.type == "Reference"; };
  return std::any_of(graph().resources.begin(), graph().resources.end(), outlives) ||
         std::any_of(graph().passes.begin(), graph().passes.end(), traces);
}

const ParamValue* LivePipeline::value_in_file(std::string_view path) const {
  const auto it = in_file_.find(path);
  return it == in_file_.end() ? nullptr : &it->second;
}

}  // namespace loom::viewer
