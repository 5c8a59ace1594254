#pragma once
// An X server of the test's own, and a person in front of it.
#include <sys/types.h>

#include <string>

#include <glm/vec2.hpp>

namespace loom::test {

/// Xvfb on a free display; DISPLAY names it while this lives.
class VirtualDisplay {
 public:
  VirtualDisplay();
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
  [[nodiscard]] bool running() const { return pid_ > 0; }
  /// What a desktop of so many dots an inch tells the programs that are started from now on.
  void set_dots_per_inch(int dots);

 private:
  pid_t pid_ = 0;
  void* resources_ = nullptr;  ///< keeps the server from forgetting them
};

/// Moves the pointer and presses keys through the X server, so that they come to the program as any other input does.
class Person {
 public:
  Person();
  ~Person();
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;
  void move_to(glm::vec2 place) const;
  void button(int number, bool down) const;
  void click(glm::vec2 place) const;
  /// By X keysym name: "space", "question", "z".
  void key(const std::string& name, bool down) const;
  void press(const std::string& name, const std::string& modifier = {}) const;

 private:
  void* display_ = nullptr;
};

}  // namespace loom::test
