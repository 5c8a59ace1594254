#pragma once
// Graphviz serves the command line alone: the framework library does without it.
#include <string>

namespace loom::cli {

/// Lays out Graphviz source. Throws Error where Graphviz cannot.
std::string svg_from_dot(const std::string& dot);

}  // namespace loom::cli
