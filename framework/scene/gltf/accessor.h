#pragma once
// Reading accessors: any component type, normalised, interleaved, sparse.
#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/document.h"

namespace loom::scene::gltf {

/// Which elements are wanted, in that order; null = all. They must be below the accessor's count.
using Selection = const std::vector<std::uint32_t>*;

/// The numbers of the selected elements, one after the other; normalised integers become [0,1] or [−1,1], others keep
/// their value.
[[nodiscard]] std::vector<float> read_floats(Document& document, int accessor, const std::string& user,
                                             Selection selection = nullptr);
/// Unsigned integers of a scalar accessor (indices).
[[nodiscard]] std::vector<std::uint32_t> read_indices(Document& document, int accessor, const std::string& user);

}  // namespace loom::scene::gltf
