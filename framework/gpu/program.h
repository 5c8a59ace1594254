#pragma once
// A linked program with what it asks for by name.
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "gpu/program_cache.h"
#include "gpu/shader_source.h"
#include "loom/gpu.h"

namespace loom::gpu {

/// Units and binding points are given out at link time, program by program, whatever the source says.
class GlProgram final : public Program {
 public:
  /// Throws Error (`shader-compile`, `shader-link`, `shader-limit`).
  static std::shared_ptr<GlProgram> compile(std::span<const ShaderSource> sources, std::string_view label);
  /// Null where the driver does not take the binary.
  static std::shared_ptr<GlProgram> restore(const ProgramBinary& binary, std::string_view label, bool compute);
  ~GlProgram() override;
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  /// Empty where the driver has no binary format.
  [[nodiscard]] ProgramBinary binary() const;

  [[nodiscard]] GlName name() const override { return name_; }
  [[nodiscard]] const ProgramInterface& interface() const override { return interface_; }
  [[nodiscard]] glm::ivec3 local_size() const override { return local_size_; }

  void set(std::string_view uniform, int value) const override;
  void set(std::string_view uniform, unsigned int value) const override;
  void set(std::string_view uniform, float value) const override;
  void set(std::string_view uniform, glm::vec2 value) const override;
  void set(std::string_view uniform, glm::vec3 value) const override;
  void set(std::string_view uniform, glm::vec4 value) const override;
  void set(std::string_view uniform, glm::ivec2 value) const override;
  void set(std::string_view uniform, glm::ivec3 value) const override;
  void set(std::string_view uniform, const glm::mat4& value) const override;

 private:
  struct Uniform {
    int location;
    unsigned int type;
  };
  struct TextHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };
  GlProgram(GlName name, std::string label);
  void introspect(bool compute);
  void introspect_uniforms();
  void introspect_blocks();
  [[nodiscard]] const Uniform* find(std::string_view uniform) const;
  template <class T>
  void set_scalar(std::string_view uniform, T value) const;

  GlName name_ = 0;
  void* context_ = nullptr;
  std::string label_;
  ProgramInterface interface_;
  glm::ivec3 local_size_{1, 1, 1};
  std::unordered_map<std::string, Uniform, TextHash, std::equal_to<>> uniforms_;
};

/// sampler2D…, sampler2DShadow…, isampler…; image2D….
bool is_sampler_type(unsigned int gl_type);
bool is_image_type(unsigned int gl_type);
bool is_shadow_sampler(unsigned int gl_type);

}  // namespace loom::gpu
