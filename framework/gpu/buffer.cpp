#include <epoxy/gl.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "gpu/current.h"
#include "gpu/debug.h"
#include "loom/diagnostic.h"
#include "loom/gpu.h"

namespace loom {
namespace {

void check_range(std::size_t offset, std::size_t count, std::size_t bytes, std::string_view what) {
  if (offset > bytes || count > bytes - offset)
    throw Error(std::string(what) + " bytes " + std::to_string(offset) + "…" + std::to_string(offset + count) +
                " of a buffer of " + std::to_string(bytes));
}

// OpenGL has no empty buffers; 16 bytes is one vec4, so that a block bound to it is never out of range. Clearing works
// in words of four bytes.
std::size_t store_bytes(std::size_t bytes) { return std::max<std::size_t>((bytes + 3) / 4 * 4, 16); }

GlName create(std::size_t bytes, const void* content, std::string_view label) {
  while (glGetError() != GL_NO_ERROR) {
  }
  GlName name = 0;
  glCreateBuffers(1, &name);
  glNamedBufferStorage(name, static_cast<GLsizeiptr>(store_bytes(bytes)), content, GL_DYNAMIC_STORAGE_BIT);
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    glDeleteBuffers(1, &name);
    throw Error("cannot allocate buffer '" + std::string(label) + "' of " + std::to_string(bytes) +
                " bytes: " + (error == GL_OUT_OF_MEMORY ? "out of memory" : "GL error " + std::to_string(error)));
  }
  gpu::label(GL_BUFFER, name, label);
  return name;
}

}  // namespace

Buffer::Buffer(std::size_t bytes, std::string_view label)
    : name_(create(bytes, nullptr, label)), bytes_(bytes), context_(gpu::current_context()) {
  clear();
}

Buffer::Buffer(std::span<const std::byte> content, std::string_view label)
    : name_(create(content.size(), content.size() == store_bytes(content.size()) ? content.data() : nullptr, label)),
      bytes_(content.size()),
      context_(gpu::current_context()) {
  if (content.size() != store_bytes(content.size())) {
    clear();
    write(content);
  }
}

Buffer Buffer::borrow(GlName name, std::size_t bytes) {
  Buffer buffer;
  buffer.name_ = name;
  buffer.owned_ = false;
  buffer.bytes_ = bytes;
  return buffer;
}

Buffer::~Buffer() {
  // Where the context is gone, so is the buffer; in another context the name means something else.
  if (name_ && owned_ && gpu::current_context() == context_) glDeleteBuffers(1, &name_);
}

Buffer::Buffer(Buffer&& other) noexcept
    : name_(std::exchange(other.name_, 0)),
      owned_(other.owned_),
      bytes_(std::exchange(other.bytes_, 0)),
      context_(other.context_) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(owned_, other.owned_);
  std::swap(bytes_, other.bytes_);
  std::swap(context_, other.context_);
  return *this;
}

void Buffer::write(std::span<const std::byte> content, std::size_t offset) const {
  check_range(offset, content.size(), bytes_, "writing");
  if (!content.empty())
    glNamedBufferSubData(name_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(content.size()), content.data());
}

void Buffer::read(std::span<std::byte> content, std::size_t offset) const {
  check_range(offset, content.size(), bytes_, "reading");
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  if (!content.empty())
    glGetNamedBufferSubData(name_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(content.size()),
                            content.data());
}

void Buffer::clear() const {
  const unsigned int zero = 0;
  const std::size_t whole = owned_ ? store_bytes(bytes_) : (bytes_ + 3) / 4 * 4;
  if (whole == 0) return;
  glClearNamedBufferSubData(name_, GL_R32UI, 0, static_cast<GLsizeiptr>(whole), GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
}

void Buffer::copy(const Buffer& from) const {
  if (from.bytes_ < bytes_) throw Error("a buffer of fewer bytes cannot fill one of more");
  if (bytes_ > 0) glCopyNamedBufferSubData(from.name_, name_, 0, 0, static_cast<GLsizeiptr>(bytes_));
}

}  // namespace loom
