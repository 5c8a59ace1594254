#include "gpu/debug.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <string_view>

#include "core/log.h"

namespace loom::gpu {
namespace {

void GLAPIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                           const GLchar* message, const void* /*user*/) {
  if (type == GL_DEBUG_TYPE_PUSH_GROUP || type == GL_DEBUG_TYPE_POP_GROUP) return;
  std::string_view text = length >= 0 ? std::string_view(message, static_cast<std::size_t>(length)) : message;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) text.remove_suffix(1);
  // What the compiler finds ends in the Error that compiling throws, with file and line.
  if (source == GL_DEBUG_SOURCE_SHADER_COMPILER)
    log().trace("OpenGL compiler [{}]: {}", id, text);
  else if (type == GL_DEBUG_TYPE_ERROR)
    log().error("OpenGL [{}]: {}", id, text);
  else if (severity == GL_DEBUG_SEVERITY_HIGH)
    log().warn("OpenGL [{}]: {}", id, text);
  else
    log().trace("OpenGL [{}]: {}", id, text);
}

}  // namespace

void install_debug_callback() {
  void* installed = nullptr;
  glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &installed);
  if (installed) return;
  glEnable(GL_DEBUG_OUTPUT);
  // Synchronous: the message comes from the very call that caused it, on the same thread.
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(on_message, nullptr);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, nullptr, GL_FALSE);
}

void label(unsigned int identifier, unsigned int name, std::string_view text) {
  if (text.empty()) return;
  // 256 is the least GL_MAX_LABEL_LENGTH, terminator included.
  glObjectLabel(identifier, name, static_cast<GLsizei>(std::min<std::size_t>(text.size(), 255)), text.data());
}

DebugGroup::DebugGroup(std::string_view name) {
  // 1024 is the least GL_MAX_DEBUG_MESSAGE_LENGTH, terminator included.
  const auto length = static_cast<GLsizei>(std::min<std::size_t>(name.size(), 1023));
  glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, length, name.data());
}

DebugGroup::~DebugGroup() { glPopDebugGroup(); }

}  // namespace loom::gpu
