#pragma once
// Colours, spacing and font of the inspector.
#include <imgui.h>

#include <bit>
#include <cstdint>

#include "loom/gpu.h"

namespace loom::viewer {

/// As the backend for OpenGL reads it: the texture's name in the place of a pointer.
inline ImTextureID image_of(const Texture& texture) {
  return std::bit_cast<ImTextureID>(static_cast<std::uintptr_t>(texture.name()));
}

/// `scale`: pixels a point. Call once, before the first frame.
void apply_theme(float scale);

namespace colour {
inline const ImVec4 accent{.36F, .67F, .93F, 1};
inline const ImVec4 changed{.98F, .76F, .36F, 1};
inline const ImVec4 error{.97F, .45F, .42F, 1};
inline const ImVec4 good{.52F, .80F, .50F, 1};
inline const ImVec4 flagged{1, 0, 1, 1};  ///< not finite, as in pictures of textures
inline const ImVec4 dim{.60F, .62F, .66F, 1};
}  // namespace colour

}  // namespace loom::viewer
