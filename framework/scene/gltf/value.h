#pragma once
// A value of a glTF file with its JSON pointer. Every read is checked: type, range, index. What is wrong ends as
// BadInput that names the file and the pointer.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "loom/diagnostic.h"

namespace loom::scene::gltf {

using Json = nlohmann::json;

/// Throws BadInput at `pointer` of `file`.
[[noreturn]] void fail(const std::string& file, const std::string& pointer, std::string code, std::string message,
                       std::string hint = {});

class Value {
 public:
  Value(const Json& json, std::string pointer, const std::string& file)
      : json_(&json), file_(&file), pointer_(std::move(pointer)) {}

  [[nodiscard]] const Json& json() const { return *json_; }
  [[nodiscard]] const std::string& pointer() const { return pointer_; }
  [[nodiscard]] SourceLocation where() const { return {*file_, 0, 0, pointer_}; }

  /// The member, or empty where absent. This value must be an object.
  [[nodiscard]] std::optional<Value> find(std::string_view key) const;
  [[nodiscard]] Value require(std::string_view key) const;
  [[nodiscard]] bool has(std::string_view key) const { return find(key).has_value(); }
  /// `extensions.<name>`, which must be an object.
  [[nodiscard]] std::optional<Value> extension(std::string_view name) const;
  /// Elements of the array `key`; empty where absent.
  [[nodiscard]] std::vector<Value> items(std::string_view key) const;
  /// The members of this object.
  [[nodiscard]] std::vector<std::pair<std::string, Value>> members() const;

  /// An integer within [min, max]; absent: `fallback`, or an error where there is none.
  [[nodiscard]] std::int64_t integer(std::string_view key, std::optional<std::int64_t> fallback, std::int64_t min,
                                     std::int64_t max) const;
  /// An index into an array of `count` things called `things`, −1 where absent.
  [[nodiscard]] int index(std::string_view key, std::size_t count, std::string_view things) const;
  [[nodiscard]] int required_index(std::string_view key, std::size_t count, std::string_view things) const;
  /// This value itself as an index.
  [[nodiscard]] int as_index(std::size_t count, std::string_view things) const;
  /// A finite number within [min, max].
  [[nodiscard]] double number(std::string_view key, std::optional<double> fallback,
                              double min = std::numeric_limits<double>::lowest(),
                              double max = std::numeric_limits<double>::max()) const;
  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback = {}) const;
  [[nodiscard]] bool flag(std::string_view key, bool fallback) const;
  /// Exactly `count` finite numbers; empty where absent.
  [[nodiscard]] std::vector<double> numbers(std::string_view key, std::size_t count) const;
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers(std::string_view key, const std::array<double, N>& fallback) const {
    const std::vector<double> list = numbers(key, N);
    std::array<double, N> result = fallback;
    for (std::size_t i = 0; i < list.size(); ++i) result[i] = list[i];
    return result;
  }

  [[noreturn]] void fail(std::string code, std::string message, std::string hint = {}) const;

 private:
  [[nodiscard]] double as_number() const;
  const Json* json_;
  const std::string* file_;
  std::string pointer_;
};

}  // namespace loom::scene::gltf
