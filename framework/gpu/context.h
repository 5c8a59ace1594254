#pragma once
// A current OpenGL 4.5 core context: headless through EGL, or one that the caller already has.
#include <memory>
#include <string>

#include "loom/export.h"

namespace loom::gpu {

/// Owns a headless context, current on the calling thread from its creation on. There may be several. Throws Error that
/// says what was tried (device platform, then surfaceless) and which package brings a software driver.
class LOOM_API Context {
 public:
  static Context headless();
  ~Context();
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;
  /// Makes it current again where another context took its place on this thread.
  void make_current() const;

 private:
  struct State;
  explicit Context(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Throws Error where no context is current, or one below 4.5 core. Installs the debug callback where there is one.
LOOM_API void require_current_context();
/// "llvmpipe (LLVM 15.0.6, 256 bits) · Mesa · 4.5 (Core Profile) Mesa 22.3.6"
LOOM_API std::string describe_device();
/// True where the current context draws on the CPU (llvmpipe, softpipe).
LOOM_API bool is_software_device();

}  // namespace loom::gpu
