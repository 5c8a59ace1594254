#pragma once
// The inspector: a window, a model, and the loop between them.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>

#include "viewer/entry.h"
#include "viewer/model.h"
#include "viewer/ui.h"
#include "viewer/user_state.h"
#include "viewer/window.h"

namespace loom::viewer {

class App {
 public:
  explicit App(const Options& options);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Until the window is closed.
  void run();
  /// Handles events, waiting up to `wait_s` for one where nothing is to be done; then draws if there is a reason to.
  void step(double wait_s);

  [[nodiscard]] Model& model() { return model_; }
  [[nodiscard]] Ui& ui() { return ui_; }
  [[nodiscard]] Window& window() { return window_; }
  /// Draws the window once more though nothing happened.
  void redraw() { redraws_ = std::max(redraws_, 1); }
  /// Windows drawn so far; with model().frames() what idling is measured by.
  [[nodiscard]] std::uint64_t drawn() const { return drawn_; }
  /// CPU time of the last drawn window beyond the pipeline, milliseconds.
  [[nodiscard]] double ui_ms() const { return ui_ms_; }

 private:
  void draw();
  void layout();
  void run_pending();
  void follow_size(double now);
  void open_dropped(const std::string& path);
  void guarded(const std::function<void()>& work);

  UserState user_;
  Window window_;  ///< its context outlives the model
  Model model_;
  Ui ui_;
  int redraws_ = 3;  ///< hovering and sizes settle over some frames
  double last_s_ = 0, polled_s_ = 0, resized_s_ = 0;
  glm::ivec2 wanted_size_{0};
  std::uint64_t drawn_ = 0;
  double ui_ms_ = 0;
};

}  // namespace loom::viewer
