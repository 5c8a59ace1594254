#pragma once
// The facts of a scene, for people and as JSON: what `info` and `analyse` print.
#include <glm/vec3.hpp>

#include "cli/json_out.h"
#include "loom/facts.h"

namespace loom::cli {

/// Adds the facts to a document, one member each. `origin`: Scene::origin; positions are shown in the file's
/// coordinates.
void add_facts(Json& document, const SceneFacts& facts, const glm::dvec3& origin);
void print_facts(const SceneFacts& facts, const glm::dvec3& origin);

}  // namespace loom::cli
