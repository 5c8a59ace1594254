#pragma once
// Frames over time, and where their time goes.

namespace loom::viewer {

struct Ui;

class ProfilePanel {
 public:
  void draw(Ui& ui);
};

}  // namespace loom::viewer
