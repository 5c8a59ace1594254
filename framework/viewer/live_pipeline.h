#pragma once
// One pipeline, compiled for the open scene and running. Where a new compilation fails, the last good one goes on.
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "gpu/device.h"
#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "interop/camera.h"
#include "loom/diagnostic.h"
#include "loom/facts.h"
#include "loom/params.h"
#include "loom/registry.h"
#include "scene/gpu_scene.h"

namespace loom::viewer {

/// "pass.param" -> value as JSON text.
using Settings = std::map<std::string, std::string>;

struct PipelineRequest {
  std::string path;
  Settings set;
  glm::ivec2 size{512, 512};
  std::vector<std::string> inspect;  ///< endpoints whose textures are kept to be looked at
};

/// What a compilation needs beside the request.
struct Surroundings {
  const Registry& registry;
  gpu::CachingDevice& device;
  const SceneFacts& facts;
};

class LivePipeline {
 public:
  /// False, with error() set, where it does not compile, does not fit into memory, or a pass cannot be prepared; what
  /// ran before then goes on. State that fits is taken over.
  bool compile(const PipelineRequest& request, const Surroundings& surroundings);
  /// False, with error() set, where the value is refused or the graph does not compile with it; nothing changed then.
  bool set_param(const std::string& pass, const std::string& param, const std::string& text,
                 const Surroundings& surroundings);
  /// False, with error() set, where a pass fails.
  bool render(const scene::GpuScene& scene, const interop::Camera& camera, const FrameInfo& info);
  /// After a shader file changed. False, with error() set: no frame is rendered until a later call succeeds.
  bool prepare_again();
  /// Takes over the state of another pipeline that was compiled from the same file.
  void adopt(const LivePipeline& other);
  /// Before the registry that it was compiled with goes.
  void close() { renderer_.reset(); }
  void reset();

  [[nodiscard]] bool running() const { return renderer_ != nullptr; }
  [[nodiscard]] bool broken() const { return broken_; }
  [[nodiscard]] const graph::Renderer& renderer() const { return *renderer_; }
  [[nodiscard]] const graph::CompiledGraph& graph() const { return renderer_->graph(); }
  [[nodiscard]] const PipelineRequest& request() const { return request_; }
  /// Files of the last request, also of one that failed: what to watch.
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }
  /// What is wrong with the newest request; empty where nothing is.
  [[nodiscard]] const Diagnostics& error() const { return error_; }
  [[nodiscard]] const Diagnostics& warnings() const { return warnings_; }
  /// True where something outlives the frame, so that frames differ though nothing changed.
  [[nodiscard]] bool has_state() const;
  /// The value that the file gives, or the declared default.
  [[nodiscard]] const ParamValue* value_in_file(std::string_view path) const;

 private:
  template <class Work>
  bool attempt(const Work& work);
  void build(const PipelineRequest& request, const Surroundings& surroundings);

  PipelineRequest request_;
  std::unique_ptr<graph::Renderer> renderer_;
  std::vector<std::string> files_;
  std::map<std::string, ParamValue, std::less<>> in_file_;
  Diagnostics error_, warnings_;
  bool broken_ = false;
};

}  // namespace loom::viewer
