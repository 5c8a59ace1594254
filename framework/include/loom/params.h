#pragma once
// A parameter is declared once. From that one declaration come JSON parsing with errors, the default, `--set`, the
// inspector's widget, the JSON Schema, the docs table, and the range and scale that a sweep may use.
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/json.h"

namespace loom {

/// What a change of the value costs: nothing, a shader variant, or a new reflection of the graph.
enum class Cost { live, shader, graph };
/// How a range is stepped through: evenly or by ratio.
enum class Scale { linear, log };
enum class ParamKind { boolean, integer, real, choice, text, colour };

struct BoolOptions {
  Cost cost = Cost::live;
  std::string doc;
};
struct IntOptions {
  int min = 0;
  int max = 0;
  std::string unit;
  Scale scale = Scale::linear;
  Cost cost = Cost::live;
  std::string doc;
};
struct RealOptions {
  double min = 0;
  double max = 1;
  std::string unit;
  Scale scale = Scale::linear;
  Cost cost = Cost::live;
  std::string doc;
};
struct TextOptions {
  Cost cost = Cost::graph;
  std::string doc;
};

using ParamTarget = std::variant<bool*, int*, float*, std::string*, glm::vec3*>;
using ParamValue = std::variant<bool, int, float, std::string, glm::vec3>;

/// One declared parameter, bound to the pass member that holds its value.
struct ParamDecl {
  std::string name;
  ParamKind kind = ParamKind::real;
  ParamTarget target;
  ParamValue default_value;
  double min = 0, max = 0;  ///< integer, real and each component of colour
  std::vector<std::string> choices;
  std::string unit;
  Scale scale = Scale::linear;
  Cost cost = Cost::live;
  std::string doc;
};

/// The parameters of one pass instance. The default of each is the member's value at the time of declaration.
class LOOM_API Params {
 public:
  void boolean(std::string name, bool& target, BoolOptions options);
  void integer(std::string name, int& target, IntOptions options);
  void real(std::string name, float& target, RealOptions options);
  /// `target` holds one of `choices`.
  void choice(std::string name, std::string& target, std::vector<std::string> choices, TextOptions options);
  void text(std::string name, std::string& target, TextOptions options);
  /// Linear Rec.709, each component within [min, max].
  void colour(std::string name, glm::vec3& target, RealOptions options);

  [[nodiscard]] const std::vector<ParamDecl>& all() const { return decls_; }
  [[nodiscard]] const ParamDecl* find(std::string_view name) const;

  /// Sets one value. Codes: `unknown-param`, `param-type`, `param-range`, `param-choice`. `owner` names the pass.
  bool set(std::string_view name, const json::Node& value, std::string_view owner, Diagnostics& diagnostics);
  /// The same from the text of `--set owner.name=text` (read as JSON where that parses, else as a bare string).
  bool set_text(std::string_view name, std::string_view text, std::string_view owner, Diagnostics& diagnostics);
  [[nodiscard]] static ParamValue value_of(const ParamDecl& decl);

 private:
  std::vector<ParamDecl> decls_;
};

}  // namespace loom
