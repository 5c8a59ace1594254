#pragma once
// The graph panel keeps its layout and where a person has moved it.
#include <imgui.h>

#include <string>

#include <glm/vec2.hpp>

#include "viewer/graph_layout.h"

namespace loom::viewer {

struct Ui;

class GraphPanel {
 public:
  void draw(Ui& ui);
  /// Middle of a node on the screen, for tests that click it; (−1, −1) where there is none.
  [[nodiscard]] glm::vec2 place_of(const std::string& pass) const;

 private:
  /// On the screen, from the layout's plane.
  [[nodiscard]] ImVec2 at(glm::vec2 p) const;
  void follow(const graph::CompiledGraph& graph, ImVec2 room);
  void draw_wires(Ui& ui, bool hovered, bool clicked);
  void draw_nodes(Ui& ui, bool hovered, bool clicked);

  GraphLayout layout_;
  std::string key_, failure_;  ///< what the layout is of; why there is none
  glm::vec2 shift_{0}, corner_{0};
  float zoom_ = 1;
  bool over_node_ = false;
};

}  // namespace loom::viewer
