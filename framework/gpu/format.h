#pragma once
// Formats and texture kinds as OpenGL names them.
#include "loom/export.h"
#include "loom/formats.h"

namespace loom::gpu {

struct GlFormat {
  unsigned int internal;     ///< sized internal format
  unsigned int layout;       ///< GL_RGBA, GL_RED_INTEGER, …: matches the texture's own channels
  unsigned int type;         ///< of one channel as stored
  unsigned int read_layout;  ///< to read back as four channels (one for depth)
  unsigned int read_type;    ///< GL_FLOAT, GL_INT or GL_UNSIGNED_INT
  int channels;
};
LOOM_API GlFormat gl_format(Format format);
unsigned int gl_target(TextureKind kind);
/// Images whose layers a framebuffer attaches as a whole.
bool is_layered(TextureKind kind);

}  // namespace loom::gpu
