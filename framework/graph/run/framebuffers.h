#pragma once
// Framebuffers made of a pass's attachments, each combination made once.
#include <map>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "loom/gpu.h"

namespace loom::graph {

class Framebuffer {
 public:
  Framebuffer();
  ~Framebuffer();
  Framebuffer(Framebuffer&& other) noexcept;
  Framebuffer(const Framebuffer&) = delete;
  Framebuffer& operator=(const Framebuffer&) = delete;
  Framebuffer& operator=(Framebuffer&&) = delete;
  [[nodiscard]] GlName name() const { return name_; }

 private:
  GlName name_ = 0;
  void* context_ = nullptr;
};

/// Colour attachments in order of their location; null = the shader's output there is dropped.
struct Attachments {
  std::vector<const Texture*> color;
  const Texture* depth = nullptr;
  glm::ivec2 empty_size{1, 1};  ///< of the raster where nothing is attached
};

class Framebuffers {
 public:
  /// Whole textures are attached: arrays, volumes and cubes are layered targets. Throws Error saying what does not fit.
  GlName get(const Attachments& attachments, const std::string& label);
  /// After textures were replaced.
  void clear() { made_.clear(); }

 private:
  std::map<std::vector<GlName>, Framebuffer> made_;  ///< by depth, then colours (0 = none)
  std::vector<GlName> key_;                          ///< kept, so that a look-up does not allocate
};

/// Width and height of the attachments.
glm::ivec2 size_of(const Attachments& attachments);
/// Layers of the attachments; 1 where they are not layered.
int layers_of(const Attachments& attachments);

}  // namespace loom::graph
