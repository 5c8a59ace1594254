#include "loom/json.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace loom::json {
namespace {

constexpr int max_depth = 64;

/// Walks the text beside nlohmann's lexer, which checks the grammar but forgets where tokens start.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) offset_ = 3;  // a byte-order mark takes no column
  }

  /// Goes to the start of the next token.
  void to_token() {
    while (offset_ < text_.size() && std::string_view(" \t\r\n,:").find(text_[offset_]) != std::string_view::npos)
      step();
  }
  /// Goes on to just behind the token that starts here.
  void past_token() {
    if (offset_ >= text_.size()) return;
    if (text_[offset_] == '"') {
      step();
      while (offset_ < text_.size() && text_[offset_] != '"') {
        if (text_[offset_] == '\\') step();
        step();
      }
      step();
    } else if (std::string_view("{}[]").find(text_[offset_]) != std::string_view::npos) {
      step();
    } else {
      const std::size_t length = word().size();
      for (std::size_t i = 0; i < length; ++i) step();
    }
  }
  void to_offset(std::size_t offset) {
    while (offset_ < std::min(offset, text_.size())) step();
  }

  /// Where the character starts whose bytes went wrong at `offset`: back over continuation bytes to one that leads.
  [[nodiscard]] std::size_t sequence_start(std::size_t offset) const {
    for (std::size_t back = 1; back <= 3 && back <= offset; ++back) {
      const auto byte = static_cast<unsigned char>(text_[offset - back]);
      const std::size_t length = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC0 ? 2 : 1;
      if (length > back) return offset - back;
      if ((byte & 0xC0u) != 0x80u) break;
    }
    return offset;
  }

  /// What stands here up to the next blank or punctuation: a number, a literal, or what was meant as one.
  [[nodiscard]] std::string_view word() const {
    const auto end = text_.find_first_of(" \t\r\n,:{}[]\"", offset_);
    return text_.substr(std::min(offset_, text_.size()), end == std::string_view::npos ? end : end - offset_);
  }
  [[nodiscard]] char behind_comma() const {  // the last token before here was a comma
    const auto last = text_.substr(0, offset_).find_last_not_of(" \t\r\n");
    return last == std::string_view::npos ? '\0' : text_[last];
  }
  [[nodiscard]] std::size_t offset() const { return offset_; }
  [[nodiscard]] bool at_end() const { return offset_ >= text_.size(); }
  [[nodiscard]] char here() const { return at_end() ? '\0' : text_[offset_]; }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] int column() const { return column_; }

 private:
  void step() {
    if (offset_ >= text_.size()) return;
    ++offset_;
    if (text_[offset_ - 1] == '\n') {
      ++line_;
      column_ = 1;
    } else if (offset_ == text_.size() || (static_cast<unsigned char>(text_[offset_]) & 0xC0u) != 0x80u) {
      ++column_;  // counts characters, not the bytes that continue one
    }
  }
  std::string_view text_;
  std::size_t offset_ = 0;
  int line_ = 1;
  int column_ = 1;
};

void append_escaped(std::string& pointer, std::string_view key) {
  pointer += '/';
  for (const char c : key) {
    if (c == '~')
      pointer += "~0";
    else if (c == '/')
      pointer += "~1";
    else
      pointer += c;
  }
}

/// Builds nodes from nlohmann's events.
class Builder {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  Builder(std::string_view text, const std::string& file, Diagnostics& diagnostics)
      : cursor_(text), file_(file), diagnostics_(diagnostics) {}

  Node take() { return std::move(root_); }

  bool null() { return leaf(Kind::null); }
  bool boolean(bool value) {
    return leaf(Kind::boolean, [&](Node& node) { node.boolean = value; });
  }
  bool number_integer(number_integer_t value) {
    return leaf(Kind::integer, [&](Node& node) {
      node.integer = value;
      node.number = static_cast<double>(value);
    });
  }
  bool number_unsigned(number_unsigned_t value) {
    if (value <= static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max()))
      return number_integer(static_cast<number_integer_t>(value));
    return leaf(Kind::number, [&](Node& node) { node.number = static_cast<double>(value); });
  }
  bool number_float(number_float_t value, const string_t&) {
    constexpr double exact = 9007199254740992.0;  // 2^53: up to here a double holds every whole number
    const bool whole = std::abs(value) <= exact && value == std::trunc(value);
    return leaf(whole ? Kind::integer : Kind::number, [&](Node& node) {
      node.number = value;
      if (whole) node.integer = static_cast<std::int64_t>(value);
    });
  }
  bool string(string_t& value) {
    return leaf(Kind::string, [&](Node& node) { node.string = std::move(value); });
  }
  bool binary(binary_t&) { return false; }  // not a thing of JSON text

  bool start_object(std::size_t) { return open(Kind::object); }
  bool start_array(std::size_t) { return open(Kind::array); }
  bool key(string_t& value) {
    cursor_.to_token();
    auto& frame = stack_.back();
    frame.key = std::move(value);
    frame.key_where = {file_, cursor_.line(), cursor_.column(), pointer_to(frame.key)};
    cursor_.past_token();
    return true;
  }
  bool end_object() {
    report_duplicates(stack_.back().node);
    return close();
  }
  bool end_array() { return close(); }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& exception) {
    const std::string what = exception.what();
    if (what.find("ill-formed UTF-8") != std::string::npos) {
      cursor_.to_offset(cursor_.sequence_start(position == 0 ? 0 : position - 1));
      diagnostics_.error("not-utf8", "byte " + std::to_string(cursor_.offset() + 1) + " of the file is not valid UTF-8",
                         here(), "save the file as UTF-8");
      return false;
    }
    cursor_.to_token();
    std::string word(cursor_.word());
    if (exception.id == 406 || means_not_finite(word)) {
      diagnostics_.error("not-finite", "`" + word + "` is not a finite number", here(),
                         "JSON holds finite numbers only, and 64-bit floats end near 1.8e308");
      return false;
    }
    std::string message = what;
    if (const auto at = message.find("syntax error "); at != std::string::npos) message.erase(0, at);
    if (const auto at = message.find("; last read"); at != std::string::npos) {
      const auto end = message.find('\'', message.find('\'', at) + 1);
      message.erase(at, end == std::string::npos ? std::string::npos : end + 1 - at);
    }
    std::string hint;
    if (cursor_.at_end())
      message += " (the file ends here)";
    else if ((cursor_.here() == '}' || cursor_.here() == ']') && cursor_.behind_comma() == ',')
      hint = "a comma may not follow the last entry";
    else if (cursor_.here() == '/' || cursor_.here() == '#')
      hint = "JSON has no comments; use \"summary\" for prose";
    else if (cursor_.here() == '\'')
      hint = "strings stand in double quotes";
    diagnostics_.error("json-syntax", std::move(message), here(), std::move(hint));
    return false;
  }

 private:
  struct Frame {
    Node node;
    std::string key;
    SourceLocation key_where;
  };

  static bool means_not_finite(std::string word) {
    for (auto& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!word.empty() && (word[0] == '-' || word[0] == '+')) word.erase(0, 1);
    return word == "nan" || word == "inf" || word == "infinity";
  }

  [[nodiscard]] std::string pointer_to(std::string_view key) const {
    std::string pointer = stack_.back().node.where.pointer;
    append_escaped(pointer, key);
    return pointer;
  }
  [[nodiscard]] std::string next_pointer() const {
    if (stack_.empty()) return {};
    const Frame& parent = stack_.back();
    if (parent.node.kind == Kind::object) return parent.key_where.pointer;
    return pointer_to(std::to_string(parent.node.items.size()));
  }
  [[nodiscard]] SourceLocation here() const { return {file_, cursor_.line(), cursor_.column(), next_pointer()}; }

  bool leaf(Kind kind) {
    return leaf(kind, [](Node&) {});
  }
  template <class Fill>
  bool leaf(Kind kind, Fill fill) {
    cursor_.to_token();
    Node node;
    node.kind = kind;
    node.where = here();
    fill(node);
    cursor_.past_token();
    attach(std::move(node));
    return true;
  }
  bool open(Kind kind) {
    cursor_.to_token();
    if (stack_.size() >= max_depth) {
      diagnostics_.error("too-deep", "nested deeper than " + std::to_string(max_depth) + " levels", here());
      return false;
    }
    Frame frame;
    frame.node.kind = kind;
    frame.node.where = here();
    cursor_.past_token();
    stack_.push_back(std::move(frame));
    return true;
  }
  bool close() {
    cursor_.to_token();
    cursor_.past_token();
    Node node = std::move(stack_.back().node);
    stack_.pop_back();
    attach(std::move(node));
    return true;
  }
  void attach(Node&& node) {
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Frame& parent = stack_.back();
    if (parent.node.kind == Kind::object)
      parent.node.members.push_back({std::move(parent.key), std::move(parent.key_where), std::move(node)});
    else
      parent.node.items.push_back(std::move(node));
  }

  void report_duplicates(Node& object) {
    auto& members = object.members;
    std::vector<std::size_t> sorted(members.size());
    std::iota(sorted.begin(), sorted.end(), std::size_t{0});
    std::stable_sort(sorted.begin(), sorted.end(), [&](auto a, auto b) { return members[a].key < members[b].key; });
    std::vector<std::size_t> extra;
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      const Member& first = members[sorted[i - 1]];
      const Member& second = members[sorted[i]];
      if (first.key != second.key) continue;
      diagnostics_.error("duplicate-key", "the key `" + second.key + "` stands twice in one object", second.key_where,
                         "the first is at line " + std::to_string(first.key_where.line) + ", column " +
                             std::to_string(first.key_where.column));
      extra.push_back(sorted[i]);
    }
    std::sort(extra.rbegin(), extra.rend());
    for (const auto index : extra) members.erase(members.begin() + static_cast<std::ptrdiff_t>(index));
  }

  Cursor cursor_;
  const std::string& file_;
  Diagnostics& diagnostics_;
  Node root_;
  std::vector<Frame> stack_;
};

}  // namespace

std::string_view to_string(Kind kind) {
  switch (kind) {
    case Kind::null:
      return "null";
    case Kind::boolean:
      return "a boolean";
    case Kind::integer:
      return "a whole number";
    case Kind::number:
      return "a number";
    case Kind::string:
      return "a string";
    case Kind::array:
      return "an array";
    case Kind::object:
      break;
  }
  return "an object";
}

const Node* Node::find(std::string_view key) const {
  const auto it = std::find_if(members.begin(), members.end(), [&](const Member& m) { return m.key == key; });
  return it == members.end() ? nullptr : &it->value;
}

Node parse(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    diagnostics.error("not-utf8", "byte 1 of the file is not valid UTF-8: this is UTF-16", {file, 1, 1, {}},
                      "save the file as UTF-8");
    return {};
  }
  if (text.find_first_not_of(" \t\r\n", text.starts_with("\xEF\xBB\xBF") ? 3 : 0) == std::string_view::npos) {
    diagnostics.error("file-empty", "the file is empty", {file, 1, 1, {}}, "the least there can be is {}");
    return {};
  }
  Builder builder(text, file, diagnostics);
  if (!nlohmann::json::sax_parse(text.begin(), text.end(), &builder)) return {};
  return builder.take();
}

Node parse_file(const std::string& path, Diagnostics& diagnostics, std::size_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    diagnostics.error("file-missing", "there is no file `" + path + "`", {path, 0, 0, {}});
    return {};
  }
  if (std::filesystem::is_directory(status)) {
    diagnostics.error("file-unreadable", "`" + path + "` is a folder", {path, 0, 0, {}});
    return {};
  }
  std::ifstream file(path, std::ios::binary);
  std::string text;
  // Read by blocks and stop at the bound: what a special file says of its own size is not to be trusted.
  std::vector<char> block(1u << 16);
  while (file && text.size() <= max_bytes) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (text.size() > max_bytes) {
    diagnostics.error("file-too-large", "the file is over " + std::to_string(max_bytes) + " bytes", {path, 0, 0, {}});
    return {};
  }
  if (file.bad() || !file.eof()) {
    diagnostics.error("file-unreadable", "cannot read `" + path + "`", {path, 0, 0, {}}, "check its permissions");
    return {};
  }
  return parse(text, path, diagnostics);
}

}  // namespace loom::json
