#pragma once
// Frame as passes see it: binds by name, draws, dispatches.
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "graph/run/bindings.h"
#include "graph/run/framebuffers.h"
#include "graph/run/storage.h"
#include "graph/run/structs.h"
#include "loom/frame.h"

namespace loom::graph {

class VertexArray {
 public:
  VertexArray();
  ~VertexArray();
  VertexArray(const VertexArray&) = delete;
  VertexArray& operator=(const VertexArray&) = delete;
  [[nodiscard]] GlName name() const { return name_; }

 private:
  GlName name_ = 0;
  void* context_ = nullptr;
};

/// Compares the receiver's reversed depth with the stored one: 1 where it is at least as near (GEQUAL), bilinear.
class ShadowSampler {
 public:
  ShadowSampler();
  ~ShadowSampler();
  ShadowSampler(const ShadowSampler&) = delete;
  ShadowSampler& operator=(const ShadowSampler&) = delete;
  [[nodiscard]] GlName name() const { return name_; }

 private:
  GlName name_ = 0;
  void* context_ = nullptr;
};

class FrameRunner final : public Frame {
 public:
  /// Both must outlive this.
  FrameRunner(const CompiledGraph& graph, const Storage& storage, const BundleStructs& structs, glm::ivec2 size);

  void begin_frame(const SceneView& scene, const interop::Camera& camera, const FrameInfo& info);
  /// The known state, and no target yet.
  void begin_pass();
  void forget_framebuffers() { framebuffers_.clear(); }

  [[nodiscard]] const FrameInfo& info() const override { return info_; }
  [[nodiscard]] glm::ivec2 size() const override { return size_; }
  [[nodiscard]] const interop::Camera& camera() const override { return camera_; }
  [[nodiscard]] const SceneView& scene() const override { return *scene_; }

  void bind(const Program& program, const Bindings& bindings) override;
  void dispatch(const Program& program, const Bindings& bindings, glm::ivec3 threads) override;
  void fullscreen(const Program& program, const Bindings& bindings) override;
  void begin_raster(const Bindings& bindings) override;
  void begin_raster(const Bindings& bindings, std::span<const std::string_view> members) override;
  void continue_raster(const Bindings& bindings, std::span<const std::string_view> members) override;
  void blend(int index, Blend mode) override;
  void points(const Program& program, const Bindings& bindings, int count) override;
  void barrier() override;

 private:
  /// One attachment: where it is, and what it is cleared to (nothing: it is kept).
  struct Target {
    const Texture* texture = nullptr;
    std::optional<glm::vec4> clear;
  };
  struct Targets {
    std::vector<Target> color;
    Target depth;
  };
  void add_target(Targets& targets, const CompiledPass& pass, const BoundPort& port, const BoundMember& member);
  [[nodiscard]] Targets all_targets(const PassBindings& bindings);
  /// The depth texture that stands in for a depth output nobody reads.
  const Texture* unread_depth(const CompiledPass& pass, const BoundPort& port, const BoundMember& member);
  [[nodiscard]] Targets named_targets(const PassBindings& bindings, std::span<const std::string_view> members);
  /// The target if there is none yet (all colour outputs), the program, and no depth test while `draw` draws.
  template <class Draw>
  void draw_undepthed(const Program& program, const PassBindings& bindings, Draw draw);
  void bind_targets(const PassBindings& bindings, const Targets& targets, bool clear);
  void bind_resources(const BindPlan& plan);

  const CompiledGraph& graph_;
  const Storage& storage_;
  const BundleStructs& structs_;
  glm::ivec2 size_;
  const SceneView* scene_ = nullptr;
  interop::Camera camera_{};
  FrameInfo info_;
  Buffer frame_data_;
  Buffer nothing_;  ///< bound where the scene has no such buffer
  VertexArray no_vertices_;
  ShadowSampler shadow_;
  Framebuffers framebuffers_;
  std::vector<std::pair<const BoundMember*, Texture>> unread_depths_;
  bool has_target_ = false;
  bool target_depth_ = false;
  int target_layers_ = 1;
};

}  // namespace loom::graph
