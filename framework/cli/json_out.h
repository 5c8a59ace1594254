#pragma once
// What goes to stdout under --json. Every document carries "version": 1.
#include <string>

#include <nlohmann/json.hpp>

#include "loom/diagnostic.h"

namespace loom::cli {

using Json = nlohmann::ordered_json;

/// {"version": 1}, to be filled.
Json versioned();
/// The components of a vector of three.
template <class V>
Json vector_json(const V& v) {
  return {v.x, v.y, v.z};
}
/// [{severity, code, message, file, line, column, pointer, hint}]
Json to_json(const Diagnostics& diagnostics);
/// Indented text with a final newline. Bytes that are not UTF-8 (file names) are replaced, numbers that are not finite
/// become null.
std::string text_of(const Json& document);
void print(const Json& document);

}  // namespace loom::cli
