#pragma once
// What is compared with what: one layer of each of two image files, chosen by name or by the quantity that they carry.
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image_io.h"
#include "loom/export.h"

namespace loom::measure {

/// Planes of width × height floats, row 0 at the top. It only views: the ImageLayers it came from must outlive it.
struct LOOM_API Layer {
  int width = 0, height = 0;
  std::string name;                            ///< "RGB" for the bare R G B, else what stands before the dot
  std::vector<std::string> channels;           ///< full EXR names, in the order of `planes`
  std::vector<std::span<const float>> planes;  ///< 1 … n, never empty
  /// Three channels R, G, B that are light or a picture of it (a normal is not): FLIP has a meaning.
  [[nodiscard]] bool is_color() const;
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

/// An image file, with what its kind says about it.
struct LOOM_API ImageFile {
  std::string path;
  ImageLayers image;
  bool hdr = false;  ///< EXR: scene-referred and unbounded; PNG: display-referred, in [0,1]
  /// `loom:quantity` of an EXR, empty where it has none; "display" for a PNG.
  [[nodiscard]] std::string quantity() const;
};

/// Reads .exr or .png by its ending (any case). Throws BadInput.
LOOM_API ImageFile read_image(const std::string& path);

/// Names of the layers of an image: "RGB", then the prefixes of dotted channels ("direct", "depth"), sorted. Where
/// there is no RGB, bare channels ("Z") are layers of their own.
LOOM_API std::vector<std::string> layer_names(const ImageLayers& image);

/// The layer of that name: empty or "RGB" (any case) for the bare R G B (or Y alone), a prefix ("indirect"), or one
/// full channel name ("depth.Z"). Throws BadInput that lists the layers there are.
LOOM_API Layer find_layer(const ImageFile& file, std::string_view name);

struct LayerPair {
  Layer a, reference;
};

/// The layers to compare. `choice` is "A:REF", or one name for both. Without it, what A's `loom:quantity` says decides:
/// radiance is compared with R G B, irradiance with the layer that `loom:output` names (absent: `indirect`), anything
/// else with the layer named like it; without a quantity it is the layer named like the output, or R G B on both sides.
/// Throws BadInput where quantities do not match, a layer is missing, or sizes or channel counts differ.
LOOM_API LayerPair match_layers(const ImageFile& a, const ImageFile& reference,
                                const std::optional<std::string>& choice = std::nullopt);

}  // namespace loom::measure
