#pragma once
// The facts of a scene, for people and as JSON: what `info` and `analyse` print.
#include "cli/json_out.h"
#include "loom/facts.h"

namespace loom::cli {

/// Adds the facts to a document, one member each.
void add_facts(Json& document, const SceneFacts& facts);
void print_facts(const SceneFacts& facts);

}  // namespace loom::cli
