#pragma once
// Values of a run file, with complaints that name their place.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "loom/diagnostic.h"
#include "loom/json.h"

namespace loom::scene::run {

using json::Kind;
using json::Node;

inline std::string with_place(std::string_view what, const Node& node) {
  return std::string(what) + ", but this is " + std::string(json::to_string(node.kind));
}

/// Reads one value after the other and keeps every complaint.
class Reader {
 public:
  explicit Reader(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void error(const Node& node, std::string code, std::string message, std::string hint = {}) {
    diagnostics_.error(std::move(code), std::move(message), node.where, std::move(hint));
  }

  /// False where `node` is no object; complains of keys that are not among `keys`.
  bool object(const Node& node, std::string_view what, const std::vector<std::string>& keys) {
    if (!node.is(Kind::object)) {
      error(node, "run-type", with_place(std::string(what) + " must be an object", node));
      return false;
    }
    for (const json::Member& member : node.members) {
      if (std::find(keys.begin(), keys.end(), member.key) != keys.end()) continue;
      std::string hint = "it may have ";
      for (std::size_t i = 0; i < keys.size(); ++i) hint += (i == 0 ? "" : ", ") + keys[i];
      const std::string nearest = nearest_name(member.key, keys);
      if (!nearest.empty()) hint = "did you mean \"" + nearest + "\"?";
      diagnostics_.error("unknown-key", std::string(what) + " has no key \"" + member.key + "\"", member.key_where,
                         hint);
    }
    return true;
  }

  std::optional<double> number(const Node* node, std::string_view what, double min, double max) {
    if (node == nullptr) return std::nullopt;
    if (!node->is_number()) {
      error(*node, "run-type", with_place(std::string(what) + " must be a number", *node));
      return std::nullopt;
    }
    if (!std::isfinite(node->number) || node->number < min || node->number > max) {
      error(*node, "run-range", std::string(what) + range_text(min, max));
      return std::nullopt;
    }
    return node->number;
  }

  std::optional<glm::dvec3> vector(const Node* node, std::string_view what,
                                   double min = std::numeric_limits<double>::lowest()) {
    if (node == nullptr) return std::nullopt;
    if (!node->is(Kind::array) || node->items.size() != 3) {
      error(*node, "run-type", std::string(what) + " must be an array of three numbers");
      return std::nullopt;
    }
    glm::dvec3 result{0};
    for (int i = 0; i < 3; ++i) {
      const std::optional<double> value =
          number(&node->items[static_cast<std::size_t>(i)], what, min, std::numeric_limits<double>::max());
      if (!value) return std::nullopt;
      result[i] = *value;
    }
    return result;
  }

  std::string text(const Node* node, std::string_view what) {
    if (node == nullptr) return {};
    if (!node->is(Kind::string)) {
      error(*node, "run-type", with_place(std::string(what) + " must be a string", *node));
      return {};
    }
    return node->string;
  }

 private:
  static std::string range_text(double min, double max) {
    std::ostringstream text;
    if (max >= std::numeric_limits<float>::max()) {
      text << " must be finite and at least " << min;
    } else {
      text << " must lie within " << min << " and " << max;
    }
    return text.str();
  }
  Diagnostics& diagnostics_;
};

}  // namespace loom::scene::run
