#pragma once
// A window with an OpenGL 4.5 context and Dear ImGui in it; what it hears between two frames.
#include <functional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

struct GLFWwindow;

namespace loom::viewer {

struct WindowOptions {
  std::string title;
  glm::ivec2 size{1440, 900};
  glm::ivec2 position{-1, -1};
  float font_scale = 1;  ///< the user's choice, on top of the desktop's
};

class Window {
 public:
  /// Throws Error that names `loom render` where there is no display, or no OpenGL 4.5 on it.
  explicit Window(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Handles what has come in; waits up to `seconds` for something. True where anything did.
  bool wait(double seconds);
  [[nodiscard]] bool should_close() const;
  void begin_frame();
  void end_frame();
  /// What was drawn, RGB rows from the top, as PNG; between begin and the swap of end_frame(), see before_swap.
  void capture(const std::string& path) const;
  std::function<void()> before_swap;  ///< called once the frame is drawn

  [[nodiscard]] GLFWwindow* handle() const { return window_; }
  [[nodiscard]] glm::ivec2 framebuffer_size() const;
  [[nodiscard]] glm::ivec2 size() const;
  [[nodiscard]] glm::ivec2 position() const;
  /// Pixels of the framebuffer a point of the desktop, times the user's choice.
  [[nodiscard]] float scale() const { return scale_; }
  /// Files that were dropped since the last call.
  std::vector<std::string> dropped();
  void set_title(const std::string& title);

 private:
  struct Events {
    bool any = false;
    float content_scale = 1;  ///< pixels of the framebuffer a point of the desktop
    std::vector<std::string> dropped;
  };
  void listen();
  static Events& events(GLFWwindow* window);

  GLFWwindow* window_ = nullptr;
  float font_scale_ = 1, scale_ = 1;
  std::string title_;
  Events events_;
};

}  // namespace loom::viewer
