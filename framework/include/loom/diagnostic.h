#pragma once
// What went wrong, where, and what to do about it. Every error that a user can cause ends as one of these.
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "loom/export.h"

namespace loom {

/// A place in a file: 1-based line and column (0 = unknown) and the JSON pointer of the value.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
  std::string pointer;
};

enum class Severity { note, warning, error };
LOOM_API std::string_view to_string(Severity severity);

/// One finding. `code` is stable kebab-case (`unknown-type`, `cycle`), `hint` says what to do.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string code;
  std::string message;
  SourceLocation where;
  std::string hint;
};

/// `file:line:column: error[code]: message` and, on a second line, `  hint: …` where there is one.
LOOM_API std::string to_string(const Diagnostic& diagnostic);

/// Collects findings, so that one run reports all of them.
class LOOM_API Diagnostics {
 public:
  void error(std::string code, std::string message, SourceLocation where = {}, std::string hint = {});
  void warning(std::string code, std::string message, SourceLocation where = {}, std::string hint = {});
  void add(Diagnostic diagnostic);
  void append(const Diagnostics& other);
  [[nodiscard]] bool has_errors() const;
  [[nodiscard]] const std::vector<Diagnostic>& all() const { return all_; }

 private:
  std::vector<Diagnostic> all_;
};

/// The work cannot go on. `BadInput` is the user's to mend (exit code 2), any other `Error` is a failure (exit code 1).
class LOOM_API Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message);
  explicit Error(Diagnostics diagnostics);
  ~Error() override;
  /// At least one entry; made from what() where only a message was given (code `failed`).
  [[nodiscard]] const Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics diagnostics_;
};

class LOOM_API BadInput : public Error {
 public:
  using Error::Error;
  explicit BadInput(Diagnostic diagnostic);
  ~BadInput() override;
};

/// The candidate nearest to `name` by edit distance, or empty where none is near enough to be a typing error.
LOOM_API std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace loom
