#pragma once
// KHR_debug: messages of the driver go to the log; groups and labels make captures readable.
#include <string_view>

namespace loom::gpu {

/// Sends the driver's messages to the log. Leaves a callback alone that the program has installed itself.
void install_debug_callback();
/// `identifier` as glObjectLabel has it (GL_TEXTURE, GL_BUFFER, GL_PROGRAM, GL_FRAMEBUFFER).
void label(unsigned int identifier, unsigned int name, std::string_view text);

/// A named span of GL commands.
class DebugGroup {
 public:
  explicit DebugGroup(std::string_view name);
  ~DebugGroup();
  DebugGroup(const DebugGroup&) = delete;
  DebugGroup& operator=(const DebugGroup&) = delete;
};

}  // namespace loom::gpu
