#pragma once
// The compiler: a pipeline file becomes a checked, culled, ordered plan with every texture's lifetime and storage slot.
// Stages 1–6 (parse, resolve, order, reflect, validate, plan); pure C++, needs no OpenGL.
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <glm/vec2.hpp>

#include "loom/bundles.h"
#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/facts.h"
#include "loom/json.h"
#include "loom/pass.h"
#include "loom/registry.h"

namespace loom::graph {

inline constexpr int none = -1;

/// `--set pass.param=value`, in order; later ones win.
struct Override {
  std::string pass, param, value;
};

struct CompileOptions {
  glm::ivec2 frame_size{512, 512};
  std::vector<Override> overrides;
  /// What is asked for: names of pipeline outputs or `pass.port[.member]`. Empty = every output that the file names.
  std::vector<std::string> requested;
  bool request_buffers = false;  ///< the inspector: `requested` may name buffers, too
  bool alias = true;
  bool prune = true;                        ///< --no-prune
  std::vector<std::string> disabled_rules;  ///< --no-prune=rule
  /// Bundles that the embedding program supplies, by name; checked against the file's "inputs".
  std::map<std::string, BundleInfo> external_inputs;
};

/// One texture or buffer of the plan. `first`…`last` are positions in CompiledGraph::order, inclusive.
struct Resource {
  std::string name;  ///< "gbuffer.surface.depth", "lpv.scratch.front", "x.y.image@prev"
  std::variant<TextureDesc, BufferDesc> desc;
  std::size_t bytes = 0;
  enum class Lifetime { transient, output, history, persistent, kept, external } lifetime = Lifetime::transient;
  int first = none, last = none;
  int slot = none;  ///< physical storage; resources that share one are never alive at once. none: external
  glm::vec4 clear{0};
  bool clear_each_frame = false;
  int history_of = none;  ///< for "@prev": the resource it is swapped with after each frame
};

struct Slot {
  std::variant<TextureDesc, BufferDesc> desc;
  std::size_t bytes = 0;
};

/// Memory that must be ordered before a pass runs, as glMemoryBarrier has it.
enum Barrier : unsigned {
  barrier_texture_fetch = 1u << 0,
  barrier_image_access = 1u << 1,
  barrier_storage = 1u << 2,
  barrier_framebuffer = 1u << 3,
  barrier_update = 1u << 4,  ///< glClear*SubData, glClearTexImage, transfers
};

struct BoundMember {
  std::string name;
  int resource = none;  ///< none: not made (nobody reads it, or its producer does not make it)
  Access access = Access::sampled;
  bool declared = true;  ///< false: the wire has it, the pass did not declare it (poison tests, debug views)
};

/// A port with what is behind it after compilation.
struct BoundPort {
  std::string name;
  std::string type;
  bool is_input = false;
  bool connected = false;
  bool history = false;  ///< "@prev"
  std::optional<std::string> absent;
  int bundle = none;  ///< index of the std140 struct's storage; shared along the wire
  std::vector<BoundMember> members;
};

struct CompiledPass {
  std::string name;
  std::string type;
  std::unique_ptr<Pass> pass;
  Params params;
  Ports ports{{1, 1}, {}};
  std::vector<BoundPort> bound;  ///< inputs, then outputs; then "scratch" and "persistent" where declared
  unsigned barriers = 0;         ///< Barrier bits to issue before it runs, and also where it keeps its outputs instead
  bool runs = true;
  SourceLocation where;
};

/// What was left out, and why; `what` is a pass ("rsm"), an output or a member ("gbuffer.surface.emission").
struct Pruned {
  std::string what, why;
};

struct Bundle {
  std::string name;  ///< "gbuffer.surface"
  std::string type;
  std::size_t struct_bytes = 0;
  std::map<std::string, Attribute, std::less<>> attributes;
  bool history = false;
};

/// A requested output: a member of a bundle, or nothing (absent: all zero).
struct GraphOutput {
  std::string name;      ///< "image", "hdr", "indirect", "bounce" or "pass.port.member"
  std::string endpoint;  ///< "tonemap.image", empty for `null`
  int resource = none;
  std::string quantity;  ///< radiance, irradiance, display, or the member's name
  std::optional<std::string> absent;
};

struct Edge {
  std::string from_pass, from_port, to_pass, to_port, type;
  bool history = false;
};

struct CompiledGraph {
  std::string name, summary, file;
  std::vector<CompiledPass> passes;  ///< as in the file, with those that do not run
  std::vector<int> order;            ///< indices of the passes that run
  std::vector<Resource> resources;
  std::vector<Slot> slots;
  std::vector<Bundle> bundles;
  std::vector<GraphOutput> outputs;
  std::vector<Edge> edges;
  std::vector<Pruned> pruned;
  std::vector<Decision> decisions;
  std::vector<std::string> files;  ///< the pipeline and what it extends, for hot reload
  std::size_t bytes = 0;           ///< textures and buffers as planned
  std::size_t bytes_without_aliasing = 0;
  [[nodiscard]] LOOM_API const CompiledPass* pass(std::string_view name) const;
};

/// `graph` is set exactly where `diagnostics` has no errors.
struct CompileResult {
  std::optional<CompiledGraph> graph;
  Diagnostics diagnostics;
};

LOOM_API CompileResult compile_file(const std::string& path, const Registry& registry, const SceneFacts& facts,
                                    const CompileOptions& options = {});
/// The same from text; `file` names it in diagnostics and anchors relative paths.
LOOM_API CompileResult compile_text(const std::string& text, const std::string& file, const Registry& registry,
                                    const SceneFacts& facts, const CompileOptions& options = {});

}  // namespace loom::graph
