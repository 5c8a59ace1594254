#pragma once
// Thin owners of OpenGL 4.5 objects. All need a current context; none keeps global state.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/export.h"
#include "loom/formats.h"

namespace loom {

using GlName = unsigned int;  ///< GLuint, without pulling a GL header into every pass

class LOOM_API Texture {
 public:
  explicit Texture(const TextureDesc& desc, std::string_view label = {});
  /// Borrows a texture that somebody else owns (embedding).
  static Texture borrow(GlName name, const TextureDesc& desc);
  ~Texture();
  Texture(Texture&& other) noexcept;
  Texture& operator=(Texture&& other) noexcept;

  [[nodiscard]] GlName name() const { return name_; }
  [[nodiscard]] const TextureDesc& desc() const { return desc_; }
  void clear(glm::vec4 value) const;
  /// Level 0 (or `mip`) of all layers as RGBA floats, or RGBA integers converted to float; row 0 is the bottom.
  [[nodiscard]] std::vector<glm::vec4> read(int mip = 0) const;
  /// Uploads tightly packed texels of the texture's own format.
  void write(std::span<const std::byte> texels, int mip = 0) const;

 private:
  Texture() = default;
  GlName name_ = 0;
  bool owned_ = true;
  void* context_ = nullptr;  ///< it was made in, the only one where its name may be deleted
  TextureDesc desc_;
};

class LOOM_API Buffer {
 public:
  explicit Buffer(std::size_t bytes, std::string_view label = {});
  Buffer(std::span<const std::byte> content, std::string_view label);
  /// The first `bytes` bytes of a buffer that somebody else owns (storage that buffers of different sizes share).
  static Buffer borrow(GlName name, std::size_t bytes);
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  [[nodiscard]] GlName name() const { return name_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  void write(std::span<const std::byte> content, std::size_t offset = 0) const;
  void read(std::span<std::byte> content, std::size_t offset = 0) const;
  void clear() const;
  /// Takes over the first bytes() bytes of `from`.
  void copy(const Buffer& from) const;

  template <class T>
  static Buffer of(std::span<const T> items, std::string_view label) {
    return Buffer(std::as_bytes(items), label);
  }

 private:
  Buffer() = default;
  GlName name_ = 0;
  bool owned_ = true;
  std::size_t bytes_ = 0;
  void* context_ = nullptr;  ///< it was made in, the only one where its name may be deleted
};

using Define = std::pair<std::string, std::string>;

/// Shader stages by file, below the shader roots (`gather_rsm/gather.comp`); the suffix names the stage. A fragment
/// stage alone gets the vertex stage of a full-screen triangle (Frame::fullscreen). `#version 450 core` and the defines
/// are put at the top; `#include "…"` is looked up beside the including file, then below the roots. `layout(binding =
/// …)` is ignored: units and binding points are given out at link time, and ProgramInterface says them.
struct ProgramDesc {
  std::vector<std::string> files;
  std::vector<Define> defines;
  bool operator==(const ProgramDesc&) const = default;
};

/// What a linked program asks for, by name: Bindings answers it (see Frame::bind).
struct ProgramInterface {
  struct Resource {
    std::string name;
    int location_or_binding = 0;
    unsigned int gl_type = 0;
  };
  std::vector<Resource> samplers, images, uniforms, uniform_blocks, storage_blocks;
};

class LOOM_API Program {
 public:
  virtual ~Program() = default;
  [[nodiscard]] virtual GlName name() const = 0;
  [[nodiscard]] virtual const ProgramInterface& interface() const = 0;
  [[nodiscard]] virtual glm::ivec3 local_size() const = 0;  ///< of a compute program, else (1,1,1)

  // Setting a uniform that the compiler has removed does nothing.
  virtual void set(std::string_view uniform, int value) const = 0;
  virtual void set(std::string_view uniform, unsigned int value) const = 0;
  virtual void set(std::string_view uniform, float value) const = 0;
  virtual void set(std::string_view uniform, glm::vec2 value) const = 0;
  virtual void set(std::string_view uniform, glm::vec3 value) const = 0;
  virtual void set(std::string_view uniform, glm::vec4 value) const = 0;
  virtual void set(std::string_view uniform, glm::ivec2 value) const = 0;
  virtual void set(std::string_view uniform, glm::ivec3 value) const = 0;
  virtual void set(std::string_view uniform, const glm::mat4& value) const = 0;
};

/// Makes GL objects for passes. Programs are cached: asking twice for one description compiles once, and program
/// binaries are kept on disk, so that a second start compiles only what changed.
class LOOM_API Device {
 public:
  virtual ~Device() = default;
  /// Throws Error with the driver's log mapped back to file:line of the included sources.
  virtual std::shared_ptr<const Program> program(const ProgramDesc& desc) = 0;
  /// Renderer, vendor, version as the driver gives them.
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace loom
