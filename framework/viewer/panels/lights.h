#pragma once
// Handles of the lights over the picture.
#include <cstddef>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "scene/scene.h"
#include "viewer/light_gizmo.h"

namespace loom::viewer {

struct Ui;

class LightHandles {
 public:
  bool on = false;
  void draw(Ui& ui);
  /// Where a handle is on the screen, for tests; (−1, −1) where it is not.
  [[nodiscard]] glm::vec2 place_of(std::size_t light, HandleKind kind) const;

 private:
  struct Drag {
    std::size_t light = 0;
    HandleKind kind = HandleKind::centre;
    glm::vec2 from{0};
    scene::Light before;
  };
  struct Shown {
    std::size_t light = 0;
    Handle handle;
  };
  void draw_light(Ui& ui, const ScreenView& view, std::size_t index);
  void draw_handle(Ui& ui, const ScreenView& view, std::size_t index, const Handle& handle);

  std::size_t selected_ = 0;
  std::optional<Drag> drag_;
  std::vector<Shown> shown_;
};

}  // namespace loom::viewer
