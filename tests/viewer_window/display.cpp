#include "viewer_window/display.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/extensions/XTest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace loom::test {
namespace {

Display* as_display(void* display) { return static_cast<Display*>(display); }

}  // namespace

VirtualDisplay::VirtualDisplay() {
  int ends[2];
  if (pipe(ends) != 0) return;
  const std::string fd = std::to_string(ends[1]);
  // 96 dots an inch: content scale 1 everywhere.
  const char* const words[] = {"Xvfb", "-displayfd", fd.c_str(),  "-screen", "0",    "1500x950x24",
                               "-dpi", "96",         "-nolisten", "tcp",     nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", 1, 0);
  const int failed = posix_spawnp(&pid_, "Xvfb", &actions, nullptr, const_cast<char* const*>(words), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed != 0) {
    pid_ = 0;
    close(ends[0]);
    return;
  }
  std::string number;
  for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number += c;
  close(ends[0]);
  setenv("DISPLAY", (":" + number).c_str(), 1);
}

void VirtualDisplay::set_dots_per_inch(int dots) {
  if (resources_ == nullptr) resources_ = XOpenDisplay(nullptr);
  Display* display = as_display(resources_);
  if (display == nullptr) throw std::runtime_error("no display");
  const std::string text = "Xft.dpi:\t" + std::to_string(dots) + "\n";
  XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(text.c_str()), static_cast<int>(text.size()));
  XSync(display, False);
}

VirtualDisplay::~VirtualDisplay() {
  if (resources_ != nullptr) XCloseDisplay(as_display(resources_));
  if (pid_ <= 0) return;
  kill(pid_, SIGTERM);
  waitpid(pid_, nullptr, 0);
}

Person::Person() : display_(XOpenDisplay(nullptr)) {
  if (display_ == nullptr) throw std::runtime_error("no display");
}
Person::~Person() { XCloseDisplay(as_display(display_)); }

void Person::move_to(glm::vec2 place) const {
  XTestFakeMotionEvent(as_display(display_), 0, static_cast<int>(place.x), static_cast<int>(place.y), CurrentTime);
  XSync(as_display(display_), False);
}

void Person::button(int number, bool down) const {
  XTestFakeButtonEvent(as_display(display_), static_cast<unsigned>(number), down ? True : False, CurrentTime);
  XSync(as_display(display_), False);
}

void Person::click(glm::vec2 place) const {
  move_to(place);
  button(1, true);
  button(1, false);
}

void Person::key(const std::string& name, bool down) const {
  const KeyCode code = XKeysymToKeycode(as_display(display_), XStringToKeysym(name.c_str()));
  if (code != 0) XTestFakeKeyEvent(as_display(display_), code, down ? True : False, CurrentTime);
  XSync(as_display(display_), False);
}

void Person::press(const std::string& name, const std::string& modifier) const {
  if (!modifier.empty()) key(modifier, true);
  key(name, true);
  key(name, false);
  if (!modifier.empty()) key(modifier, false);
}

}  // namespace loom::test
