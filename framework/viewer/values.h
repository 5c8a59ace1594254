#pragma once
// Parameter values as text, the way --set and pipeline files write them.
#include <string>

#include "loom/params.h"

namespace loom::viewer {

/// JSON; floats in the fewest digits that give the same number back.
std::string json_text(const ParamValue& value);
/// For a command line: without the quotes of JSON where the value is a plain word.
std::string set_text(const std::string& json);
/// One word of a POSIX shell.
std::string shell_word(const std::string& text);

}  // namespace loom::viewer
