#include "viewer/values.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <type_traits>
#include <variant>

#include <nlohmann/json.hpp>

namespace loom::viewer {
namespace {

std::string number(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

}  // namespace

std::string json_text(const ParamValue& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>) {
          return v ? "true" : "false";
        } else if constexpr (std::is_same_v<T, int>) {
          return std::to_string(v);
        } else if constexpr (std::is_same_v<T, float>) {
          return number(v);
        } else if constexpr (std::is_same_v<T, std::string>) {
          return nlohmann::json(v).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
        } else {
          return "[" + number(v.x) + "," + number(v.y) + "," + number(v.z) + "]";
        }
      },
      value);
}

std::string set_text(const std::string& json) {
  const bool quoted = json.size() > 2 && json.front() == '"' && json.back() == '"';
  if (!quoted) return json;
  const std::string inner = json.substr(1, json.size() - 2);
  const bool word =
      std::isalpha(static_cast<unsigned char>(inner.front())) != 0 &&
      std::all_of(inner.begin(), inner.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
  return word ? inner : json;
}

std::string shell_word(const std::string& text) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-./=,:+").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace loom::viewer
