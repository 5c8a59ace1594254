#include "loom/diagnostic.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace loom {
namespace {

std::string summary(const Diagnostics& diagnostics) {
  std::string text;
  for (const auto& diagnostic : diagnostics.all()) {
    if (!text.empty()) text += '\n';
    text += to_string(diagnostic);
  }
  return text.empty() ? "failed" : text;
}

Diagnostics of(Diagnostic diagnostic) {
  Diagnostics diagnostics;
  diagnostics.add(std::move(diagnostic));
  return diagnostics;
}

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// Optimal string alignment: insertions, deletions, substitutions and swaps of neighbours; case is free.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(now);
  }
  return last[b.size()];
}

}  // namespace

std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      break;
  }
  return "error";
}

std::string to_string(const Diagnostic& diagnostic) {
  std::string text;
  if (!diagnostic.where.file.empty()) {
    text += diagnostic.where.file + ':';
    if (diagnostic.where.line > 0) {
      text += std::to_string(diagnostic.where.line) + ':';
      if (diagnostic.where.column > 0) text += std::to_string(diagnostic.where.column) + ':';
    }
    text += ' ';
  }
  text += to_string(diagnostic.severity);
  text += '[' + diagnostic.code + "]: " + diagnostic.message;
  if (!diagnostic.hint.empty()) text += "\n  hint: " + diagnostic.hint;
  return text;
}

void Diagnostics::error(std::string code, std::string message, SourceLocation where, std::string hint) {
  add({Severity::error, std::move(code), std::move(message), std::move(where), std::move(hint)});
}

void Diagnostics::warning(std::string code, std::string message, SourceLocation where, std::string hint) {
  add({Severity::warning, std::move(code), std::move(message), std::move(where), std::move(hint)});
}

void Diagnostics::add(Diagnostic diagnostic) { all_.push_back(std::move(diagnostic)); }

void Diagnostics::append(const Diagnostics& other) { all_.insert(all_.end(), other.all_.begin(), other.all_.end()); }

bool Diagnostics::has_errors() const {
  return std::any_of(all_.begin(), all_.end(), [](const auto& d) { return d.severity == Severity::error; });
}

Error::Error(const std::string& message) : std::runtime_error(message) { diagnostics_.error("failed", message); }

Error::Error(Diagnostics diagnostics) : std::runtime_error(summary(diagnostics)), diagnostics_(std::move(diagnostics)) {
  if (diagnostics_.all().empty()) diagnostics_.error("failed", what());
}

Error::~Error() = default;

BadInput::BadInput(Diagnostic diagnostic) : Error(of(std::move(diagnostic))) {}
BadInput::~BadInput() = default;

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  // One slip in a short name, two in a longer one, a third of a long one: beyond that it is another word.
  const std::size_t limit = name.size() <= 3 ? 1 : std::max<std::size_t>(2, name.size() / 3);
  std::size_t best = limit + 1;
  std::string_view nearest;
  for (const auto& candidate : candidates) {
    if (candidate.size() > name.size() + limit || name.size() > candidate.size() + limit) continue;
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return std::string(nearest);
}

}  // namespace loom
