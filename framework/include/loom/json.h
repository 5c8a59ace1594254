#pragma once
// JSON that remembers where each value stood, so that every diagnostic can point at file:line:column.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "loom/diagnostic.h"
#include "loom/export.h"

namespace loom::json {

enum class Kind { null, boolean, integer, number, string, array, object };
LOOM_API std::string_view to_string(Kind kind);

struct Member;

/// An immutable value with its place. Objects keep the order of their keys; `integer` is a number with no fraction.
struct LOOM_API Node {
  Kind kind = Kind::null;
  SourceLocation where;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0;  ///< set for `integer` too
  std::string string;
  std::vector<Node> items;
  std::vector<Member> members;

  [[nodiscard]] bool is(Kind k) const { return kind == k; }
  [[nodiscard]] bool is_number() const { return kind == Kind::integer || kind == Kind::number; }
  /// The member of that name, or null (also when this is no object).
  [[nodiscard]] const Node* find(std::string_view key) const;
};

struct LOOM_API Member {
  std::string key;
  SourceLocation key_where;
  Node value;
};

/// Parses UTF-8 text. Reports syntax errors, duplicate keys, nesting over 64 levels, numbers that are not finite and
/// bytes that are not UTF-8 into `diagnostics`. Returns a null node where the text cannot be read to its end; after a
/// duplicate key (the first one counts) the rest is there, so that its mistakes can be reported too. Codes:
/// json-syntax, duplicate-key, too-deep, not-finite, not-utf8, file-empty, file-missing, file-too-large,
/// file-unreadable.
LOOM_API Node parse(std::string_view text, const std::string& file, Diagnostics& diagnostics);
/// The same for a file; missing, unreadable, empty or over `max_bytes` is a diagnostic too.
LOOM_API Node parse_file(const std::string& path, Diagnostics& diagnostics, std::size_t max_bytes = 64u << 20);

}  // namespace loom::json
