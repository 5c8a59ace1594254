#pragma once
// What a pass consumes and produces, declared in Pass::reflect() with no OpenGL at hand.
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "loom/bundles.h"
#include "loom/export.h"
#include "loom/formats.h"

namespace loom {

/// A texture or buffer that a pass declares as member of an output, as scratch, or as persistent state.
struct MemberDecl {
  std::string name;
  std::variant<TextureDesc, BufferDesc> desc;
  Access access = Access::image_write;
  glm::vec4 clear{0};                   ///< what a history or persistent texture holds before its first frame
  bool clear_each_frame = false;        ///< the executor clears it to `clear` before the pass runs
  bool needed = false;                  ///< the pass reads it back itself: made whenever the pass runs
  std::vector<std::string> needed_for;  ///< members of the same output that it is read back for: made with any of them
};

struct ReadDecl {
  std::string member;
  Access access = Access::sampled;
};

struct InputDecl {
  std::string name;
  std::string type;  ///< bundle type, or "*" for any
  bool optional = false;
  std::vector<ReadDecl> reads;
  bool reads_all = false;  ///< every member there is, sampled
};

struct OutputDecl {
  std::string name;
  std::string type;
  std::vector<MemberDecl> members;
  std::map<std::string, Attribute, std::less<>> attributes;
  std::optional<std::string> absent;    ///< why there is nothing to carry
  std::optional<std::string> forwards;  ///< input whose bundle goes on unchanged
  std::optional<std::string> in_place;  ///< input whose storage this output takes over and changes
};

/// Why something was or was not done, with the evidence: a row of `loom plan`.
struct Decision {
  std::string rule;
  std::string decision;
  std::string evidence;
  std::string pass;  ///< filled in by the compiler; empty: the whole graph
};

/// What a wire brings, as far as it is known at reflect time.
struct BundleInfo {
  std::string type;
  std::vector<MemberDecl> members;
  std::map<std::string, Attribute, std::less<>> attributes;
  std::optional<std::string> absent;
};

class Ports;

/// What a pass that keeps its outputs does when it runs again: makes them whole, or renews parts of them.
enum class Keep { whole, parts };

/// Handle on a declared input.
class LOOM_API InputPort {
 public:
  InputPort& optional();
  /// Declares that the pass reads this member. A member that the type lacks is an error; one that the producer does
  /// not make is simply not there: ask texture().
  InputPort& reads(std::string_view member, Access access = Access::sampled);
  InputPort& reads_all();

  [[nodiscard]] bool connected() const;
  /// True where the wire carries nothing (no lights in the scene) or there is no wire.
  [[nodiscard]] bool absent() const;
  [[nodiscard]] std::string why_absent() const;
  /// The descriptor of a member that the producer makes; null where it makes none, where the wire carries nothing, and
  /// for a history wire as long as its producer was not reflected yet (reflect() then runs again).
  [[nodiscard]] const TextureDesc* texture(std::string_view member) const;
  [[nodiscard]] int attribute(std::string_view name, int fallback) const;
  [[nodiscard]] std::string attribute(std::string_view name, std::string_view fallback) const;
  [[nodiscard]] const BundleInfo* info() const;  ///< null where not connected
 private:
  friend class Ports;
  InputPort(Ports& ports, std::size_t index) : ports_(&ports), index_(index) {}
  Ports* ports_;
  std::size_t index_;
};

/// Handle on a declared output.
class LOOM_API OutputPort {
 public:
  OutputPort& texture(std::string_view member, const TextureDesc& desc, Access access);
  OutputPort& buffer(std::string_view member, const BufferDesc& desc, Access access = Access::storage_write);
  OutputPort& cleared(std::string_view member, glm::vec4 value = glm::vec4(0));  ///< cleared before each frame
  OutputPort& initial(std::string_view member, glm::vec4 value);                 ///< as history, before the first frame
  OutputPort& needed(std::string_view member);  ///< made whenever the pass runs: it reads the member back itself
  OutputPort& needed(std::string_view member, std::string_view whenever);  ///< made with that other member
  OutputPort& attribute(std::string_view name, Attribute value);
  /// Nothing to carry; `why` is shown by `loom plan`. A pass whose outputs are all absent does not run.
  void absent(std::string why);
  /// The input's bundle goes on unchanged. A pass whose outputs are all absent or forwarded does not run.
  void forwards(std::string_view input);
  /// Writes into the input's storage; every other reader of the input runs before. Members are the input's.
  OutputPort& in_place(std::string_view input);

 private:
  friend class Ports;
  OutputPort(Ports& ports, std::size_t index) : ports_(&ports), index_(index) {}
  Ports* ports_;
  std::size_t index_;
};

/// The declaration of one pass in one graph. Made by the compiler, filled by Pass::reflect(), which declares every port
/// whatever its inputs carry: an output with nothing to carry is declared and made absent().
class LOOM_API Ports {
 public:
  using Upstream = std::map<std::string, BundleInfo, std::less<>>;
  Ports(glm::ivec2 frame_size, Upstream upstream, std::function<bool(std::string_view)> rule_enabled = {});

  [[nodiscard]] glm::ivec2 frame_size() const { return frame_size_; }
  InputPort in(std::string_view name, std::string_view bundle_type);
  OutputPort out(std::string_view name, std::string_view bundle_type);
  /// Storage used inside execute() only. Read it back by Bindings as "scratch.<name>".
  void scratch(std::string_view name, const TextureDesc& desc, Access access);
  void scratch(std::string_view name, const BufferDesc& desc);
  /// State that outlives the frame, as "persistent.<name>"; cleared at first and when the graph is reset.
  void persistent(std::string_view name, const TextureDesc& desc, Access access, glm::vec4 clear = glm::vec4(0));
  void persistent(std::string_view name, const BufferDesc& desc);
  /// Outputs may be kept while fingerprint() does not change: they get storage of their own. Nothing where the rule
  /// `static` is off. `parts`: where the pass runs again it may leave parts of them as they are (Bindings::kept).
  void keep_outputs(Keep what = Keep::whole);
  /// The pass has an effect beyond its outputs (a readback, a file) and is never culled.
  void side_effect();

  /// False where `--no-prune` switched this rule off; a rule that is off decides nothing.
  [[nodiscard]] bool rule(std::string_view name) const;
  void decide(std::string rule, std::string decision, std::string evidence);
  /// A wiring that the pass cannot work with; becomes a diagnostic at the pass.
  void error(std::string code, std::string message, std::string hint = {});

  struct Issue {
    std::string code, message, hint;
  };
  // Read by the compiler.
  std::vector<InputDecl> inputs;
  std::vector<OutputDecl> outputs;
  std::vector<MemberDecl> scratches;
  std::vector<MemberDecl> persistents;
  std::vector<Decision> decisions;
  std::vector<Issue> issues;
  bool keeps_outputs = false, renews_parts = false;
  bool has_side_effect = false;

 private:
  friend class InputPort;
  friend class OutputPort;
  glm::ivec2 frame_size_;
  Upstream upstream_;
  std::function<bool(std::string_view)> rule_enabled_;
};

}  // namespace loom
