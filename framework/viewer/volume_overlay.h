#pragma once
// The inspected volume drawn at its place: bodies over the picture, hidden where the scene's surfaces are nearer.
#include <cstdint>
#include <memory>
#include <string>

#include <glm/vec2.hpp>

#include "loom/gpu.h"
#include "viewer/model.h"
#include "viewer/volume_cells.h"

namespace loom::viewer {

class VolumeOverlay {
 public:
  VolumeOverlay() = default;
  ~VolumeOverlay();
  VolumeOverlay(const VolumeOverlay&) = delete;
  VolumeOverlay& operator=(const VolumeOverlay&) = delete;

  /// Draws anew where anything changed since the last call. `size`: pixels that the picture takes on the screen. Throws
  /// Error where a program does not compile.
  void update(const Model& model, const VolumeSettings& settings, const TextureViewSettings& view, glm::ivec2 size);
  /// Null where nothing is drawn.
  [[nodiscard]] const Texture* picture() const { return drawn_ ? colour_.get() : nullptr; }
  [[nodiscard]] const CellMesh& mesh() const { return mesh_; }
  [[nodiscard]] int parts() const { return parts_; }
  /// What a person points at, as text; empty where that is none of the bodies. `at`: share of the picture from its
  /// lower left.
  [[nodiscard]] std::string text_at(const Model& model, glm::vec2 at) const;

 private:
  void follow(const Model& model, const VolumeSettings& settings, const TextureViewSettings& view);
  void draw(const Model& model, glm::ivec2 size);

  CellMesh mesh_;
  std::unique_ptr<Buffer> vertices_, indices_;
  std::unique_ptr<Texture> colour_, depth_;
  std::uint32_t vertex_array_ = 0, framebuffer_ = 0;
  bool drawn_ = false;
  int parts_ = 1;
  // What the mesh, and what the picture, was made of.
  std::string name_;
  std::uint64_t version_ = 0, mesh_version_ = 0, drawn_mesh_ = 0, drawn_view_ = 0;
  std::uint32_t texture_ = 0;
  VolumeSettings settings_;
  TextureViewSettings view_;
};

}  // namespace loom::viewer
