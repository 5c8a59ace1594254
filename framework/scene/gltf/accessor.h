#pragma once
// Reading accessors: any component type, normalised, interleaved, sparse.
#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/document.h"

namespace loom::scene::gltf {

/// `count · components` numbers; normalised integers become [0,1] or [−1,1], others keep their value.
[[nodiscard]] std::vector<float> read_floats(Document& document, int accessor, const std::string& user);
/// Unsigned integers of a scalar accessor (indices).
[[nodiscard]] std::vector<std::uint32_t> read_indices(Document& document, int accessor, const std::string& user);

/// The same as vectors of glm type T (float components); fails where the accessor has another number of components.
template <class T>
[[nodiscard]] std::vector<T> read_vectors(Document& document, int accessor, const std::string& user) {
  const Accessor& a = document.accessors()[static_cast<std::size_t>(accessor)];
  if (a.components != T::length()) {
    document.fail(user, "gltf-type",
                  a.pointer + " has " + std::to_string(a.components) + " components, but " +
                      std::to_string(T::length()) + " are needed");
  }
  const std::vector<float> numbers = read_floats(document, accessor, user);
  std::vector<T> result(a.count);
  for (std::size_t i = 0; i < a.count; ++i) {
    for (int c = 0; c < T::length(); ++c) {
      result[i][c] = static_cast<typename T::value_type>(
          numbers[i * static_cast<std::size_t>(T::length()) + static_cast<std::size_t>(c)]);
    }
  }
  return result;
}

}  // namespace loom::scene::gltf
