#include "gpu/context.h"

#include <epoxy/gl.h>

#include <string>

#include "gpu/current.h"
#include "gpu/debug.h"
#include "loom/diagnostic.h"

namespace loom::gpu {
namespace {

std::string gl_string(GLenum name) {
  const auto* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "?";
}

}  // namespace

void require_current_context() {
  if (!current_context())
    throw Error("no OpenGL context is current on this thread: create one (loom::gpu::Context::headless()) first");
  GLint major = 0, minor = 0, profile = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (major * 10 + minor >= 32) glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
  if (major * 10 + minor < 45 || !(profile & GL_CONTEXT_CORE_PROFILE_BIT))
    throw Error("the current OpenGL context is " + gl_string(GL_VERSION) + "; 4.5 core is needed");
  install_debug_callback();
}

bool is_software_device() {
  const std::string renderer = gl_string(GL_RENDERER);
  return renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe");
}

std::string describe_device() {
  return gl_string(GL_RENDERER) + " · " + gl_string(GL_VENDOR) + " · " + gl_string(GL_VERSION);
}

}  // namespace loom::gpu
