#pragma once
// What a pass sees of its ports, and how the names in its shaders find them.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "graph/compile/compile.h"
#include "graph/run/keep.h"
#include "graph/run/storage.h"
#include "graph/run/structs.h"
#include "loom/frame.h"

namespace loom::graph {

/// How one program's names are answered for one pass; found once, used every frame.
struct BindPlan {
  struct TextureUnit {
    GlName unit = 0;
    int resource = none;
    std::string scene;  ///< sampler of SceneView::texture(), where no resource
    bool shadow = false;
  };
  struct ImageUnit {
    GlName unit = 0;
    int resource = none;
    Access access = Access::image_read_write;
  };
  struct StorageBlock {
    GlName binding = 0;
    int resource = none;
    std::string scene;  ///< block of SceneView::buffer(), where no resource
  };
  struct UniformBlock {
    GlName binding = 0;
    int bundle = none;  ///< none: frame_data
  };
  struct Uniform {
    std::string name;
    const ParamDecl* param = nullptr;
  };
  std::vector<TextureUnit> textures;
  std::vector<ImageUnit> images;
  std::vector<StorageBlock> storage;
  std::vector<UniformBlock> blocks;
  std::vector<Uniform> params;
};

class PassBindings final : public Bindings {
 public:
  /// Everything must outlive this. `history_valid` is the renderer's.
  PassBindings(const CompiledPass& pass, const CompiledGraph& graph, const Storage& storage, BundleStructs& structs,
               const KeepTracker& keep, const bool& history_valid);

  [[nodiscard]] const Texture& texture(std::string_view path) const override;
  [[nodiscard]] const Buffer& buffer(std::string_view path) const override;
  [[nodiscard]] bool has(std::string_view path) const override;
  [[nodiscard]] bool absent(std::string_view input) const override;
  [[nodiscard]] bool history_valid(std::string_view input) const override;
  [[nodiscard]] bool kept() const override;
  [[nodiscard]] std::uint64_t revision(std::string_view input) const override;

  [[nodiscard]] const CompiledPass& pass() const { return pass_; }
  /// The plan for a program, made at first use. Throws Error (`bind`) naming what the program asks for in vain.
  const BindPlan& plan(const Program& program) const;
  void forget_plans() const { plans_.clear(); }
  /// The member at "port.member" as the plan has it, made or not; throws Error naming the nearest path.
  [[nodiscard]] const BoundMember& member(std::string_view path) const;

 protected:
  void publish_bytes(std::string_view output, std::span<const std::byte> data) const override;
  [[nodiscard]] std::span<const std::byte> data_bytes(std::string_view port, std::size_t bytes) const override;

 private:
  struct TextHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };
  template <class T>
  using ByName = std::unordered_map<std::string, T, TextHash, std::equal_to<>>;
  struct Entry {
    const BoundPort* port = nullptr;
    std::vector<const BoundMember*> members;  ///< more than one where it is declared with several accesses
  };

  [[nodiscard]] const BoundPort& port(std::string_view name) const;
  [[nodiscard]] const Entry* find(std::string_view path) const;
  [[nodiscard]] int resource(std::string_view path, bool texture) const;
  [[nodiscard]] BindPlan make_plan(const Program& program) const;
  [[nodiscard]] const BoundMember* answer(const std::string& name, std::string_view as, bool image, bool block) const;
  [[noreturn]] void fail(const std::string& message, const std::string& hint = {}) const;

  const CompiledPass& pass_;
  const CompiledGraph& graph_;
  const Storage& storage_;
  BundleStructs& structs_;
  const KeepTracker& keep_;
  const bool& history_valid_;
  ByName<Entry> paths_;    ///< "surface.depth"
  ByName<Entry> symbols_;  ///< "surface_depth"
  mutable std::unordered_map<const Program*, BindPlan> plans_;
};

}  // namespace loom::graph
