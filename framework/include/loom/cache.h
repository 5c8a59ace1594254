#pragma once
// What is dear to make and the same whenever it is made: bytes kept in the user's cache folder, by name.
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "loom/export.h"

namespace loom {

/// The bytes kept by that name; nothing where there are none, or another number of them. The name says all that the
/// content depends on, versions included.
LOOM_API std::optional<std::vector<std::byte>> read_cached(std::string_view name, std::size_t bytes);
/// Keeps them; written beside, then renamed. A cache that cannot be written is a warning.
LOOM_API void write_cached(std::string_view name, std::span<const std::byte> bytes);

}  // namespace loom
