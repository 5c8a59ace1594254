#include "viewer/window.h"

#include <epoxy/gl.h>

#include <cstddef>
#include <utility>

// After the loader, which must come first.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <glm/vec3.hpp>

#include "core/image_io.h"
#include "loom/diagnostic.h"
#include "viewer/theme.h"

namespace loom::viewer {
namespace {

[[noreturn]] void no_window(const std::string& what) {
  const char* reason = nullptr;
  glfwGetError(&reason);
  Diagnostics diagnostics;
  diagnostics.error("no-display", what + (reason != nullptr ? std::string(": ") + reason : std::string()), {},
                    "`loom render -p PIPELINE -o out.png` draws without a display; xvfb-run gives one to programs that "
                    "need one");
  throw Error(std::move(diagnostics));
}

}  // namespace

Window::Window(const WindowOptions& options) : title_(options.title) {
  if (glfwInit() == GLFW_FALSE) no_window("there is no display to open a window on");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  window_ = glfwCreateWindow(options.size.x, options.size.y, title_.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    try {
      no_window("the display gives no OpenGL 4.5 core context");
    } catch (...) {
      glfwTerminate();
      throw;
    }
  }
  if (options.position.x >= 0) glfwSetWindowPos(window_, options.position.x, options.position.y);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  font_scale_ = options.font_scale;
  if (x > 0) events_.content_scale = x;
  scale_ = events_.content_scale * font_scale_;

  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // the layout is fixed; the window's place is ours to keep
  apply_theme(scale_);
  listen();
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
  glfwFocusWindow(window_);
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

Window::Events& Window::events(GLFWwindow* window) {
  return static_cast<Window*>(glfwGetWindowUserPointer(window))->events_;
}

// ImGui chains its callbacks to those that are there before it.
void Window::listen() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int, int, int, int) { events(w).any = true; });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned) { events(w).any = true; });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int, int, int) { events(w).any = true; });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double) { events(w).any = true; });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double, double) { events(w).any = true; });
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* w, int) { events(w).any = true; });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int) { events(w).any = true; });
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { events(w).any = true; });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { events(w).any = true; });
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* w, float x, float) {
    events(w).any = true;
    if (x > 0) events(w).content_scale = x;
  });
  glfwSetWindowCloseCallback(window_, [](GLFWwindow* w) { events(w).any = true; });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    events(w).any = true;
    for (int i = 0; i < count; ++i) events(w).dropped.emplace_back(paths[i]);
  });
}

bool Window::wait(double seconds) {
  events_.any = false;
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
  return events_.any;
}

bool Window::should_close() const { return glfwWindowShouldClose(window_) != GLFW_FALSE; }

void Window::begin_frame() {
  // A window that came to another screen: its letters are drawn anew, of the size that they have there.
  if (const float wanted = events_.content_scale * font_scale_; wanted != scale_) {
    scale_ = wanted;
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    apply_theme(scale_);
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Window::end_frame() {
  ImGui::Render();
  const glm::ivec2 size = framebuffer_size();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, size.x, size.y);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(.09F, .09F, .1F, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (before_swap) before_swap();
  glfwSwapBuffers(window_);
}

void Window::capture(const std::string& path) const {
  const glm::ivec2 size = framebuffer_size();
  std::vector<unsigned char> bytes(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * 3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.x, size.y, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
  std::vector<glm::vec3> pixels;
  pixels.reserve(bytes.size() / 3);
  for (int y = size.y - 1; y >= 0; --y)
    for (int x = 0; x < size.x; ++x) {
      const unsigned char* p =
          &bytes[(static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)) * 3];
      pixels.emplace_back(glm::vec3(p[0], p[1], p[2]) / 255.F);
    }
  write_png(path, size.x, size.y, pixels);
}

glm::ivec2 Window::framebuffer_size() const {
  glm::ivec2 size{0};
  glfwGetFramebufferSize(window_, &size.x, &size.y);
  return size;
}

glm::ivec2 Window::size() const {
  glm::ivec2 size{0};
  glfwGetWindowSize(window_, &size.x, &size.y);
  return size;
}

glm::ivec2 Window::position() const {
  glm::ivec2 position{0};
  glfwGetWindowPos(window_, &position.x, &position.y);
  return position;
}

std::vector<std::string> Window::dropped() { return std::exchange(events_.dropped, {}); }

void Window::set_title(const std::string& title) {
  if (title == title_) return;
  title_ = title;
  glfwSetWindowTitle(window_, title_.c_str());
}

}  // namespace loom::viewer
