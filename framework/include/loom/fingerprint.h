#pragma once
// What passes make fingerprints of (Pass::fingerprint).
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "loom/scene_view.h"

namespace loom {

/// Equal numbers mean that a result which depends on geometry, lights, sky and the seed alone is the same. Both
/// versions count changes of one scene, so that their pair names its state.
inline std::uint64_t scene_version(const SceneView& scene, std::uint32_t seed = 0) {
  return scene.geometry_version() * 0x9e3779b97f4a7c15u ^ scene.lights_version() ^ std::uint64_t{seed} << 32;
}

/// `hash` changed by the bytes of `value` (64-bit FNV-1a).
template <class T>
std::uint64_t mix_in(std::uint64_t hash, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  for (const std::byte byte : std::as_bytes(std::span(&value, 1))) {
    hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace loom
