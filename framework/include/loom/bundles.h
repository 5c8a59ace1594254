#pragma once
// A bundle is what one wire carries: a named set of textures and buffers and one std140 struct. Its type says which
// members it can have and what they mean.
#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "loom/export.h"

namespace loom {

enum class MemberKind { texture, buffer };

struct BundleMember {
  std::string name;
  MemberKind kind = MemberKind::texture;
  std::string unit;  ///< `W/m²`, `m`; empty = dimensionless
  std::string doc;
  bool operator==(const BundleMember&) const = default;
};

/// The first member is the primary one: what is shown or written when a bundle is asked for without naming a member.
struct LOOM_API BundleType {
  std::string name;
  int version = 1;
  std::vector<BundleMember> members;
  std::size_t struct_bytes = 0;  ///< size of the std140 struct (shaders/interop), 0 = none
  std::string doc;
  /// Identical declarations merge; the prose may differ.
  [[nodiscard]] bool same_layout(const BundleType& other) const;
  [[nodiscard]] const BundleMember* find(std::string_view member) const;
};

/// The types that every pipeline may use: Surface, LightLayers, GeometryImage, ShVolume, VoxelScene, ProbeField,
/// VplSet, Irradiance, Image.
LOOM_API const std::vector<BundleType>& builtin_bundles();

/// Known at reflect time and carried by the wire: `bands`, `channels`, `cascades`, `basis`, `buffers`, `quantity`.
using Attribute = std::variant<int, double, std::string>;

}  // namespace loom
