#include "gpu/program.h"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>
#include <type_traits>
#include <utility>

#include "gpu/current.h"
#include "gpu/debug.h"
#include "loom/diagnostic.h"

namespace loom::gpu {
namespace {

[[noreturn]] void fail(std::string code, std::string message, std::string hint = {}) {
  Diagnostics diagnostics;
  diagnostics.error(std::move(code), std::move(message), {}, std::move(hint));
  throw Error(std::move(diagnostics));
}

// The stages' names, for messages: "lib/fullscreen.vert + tonemap/tonemap.frag".
std::string names(std::span<const ShaderSource> sources) {
  std::string text;
  for (const ShaderSource& source : sources) text += (text.empty() ? "" : " + ") + source.name;
  return text;
}

class Shader {
 public:
  explicit Shader(const ShaderSource& source) : name_(glCreateShader(source.stage)) {
    const char* text = source.text.c_str();
    const auto length = static_cast<GLint>(source.text.size());
    glShaderSource(name_, 1, &text, &length);
    glCompileShader(name_);
  }
  ~Shader() {
    if (name_) glDeleteShader(name_);
  }
  Shader(Shader&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  Shader& operator=(Shader&&) = delete;

  [[nodiscard]] GLuint name() const { return name_; }
  [[nodiscard]] bool good() const {
    GLint status = GL_FALSE;
    glGetShaderiv(name_, GL_COMPILE_STATUS, &status);
    return status == GL_TRUE;
  }
  [[nodiscard]] std::string log() const {
    GLint length = 0;
    glGetShaderiv(name_, GL_INFO_LOG_LENGTH, &length);
    std::string text(static_cast<std::size_t>(std::max(length, 0)), '\0');
    if (length > 0) glGetShaderInfoLog(name_, length, nullptr, text.data());
    return text.substr(0, text.find('\0'));
  }

 private:
  GLuint name_;
};

bool linked(GLuint program) {
  GLint status = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &status);
  return status == GL_TRUE;
}

std::string program_log(GLuint program) {
  GLint length = 0;
  glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
  std::string text(static_cast<std::size_t>(std::max(length, 0)), '\0');
  if (length > 0) glGetProgramInfoLog(program, length, nullptr, text.data());
  text = text.substr(0, text.find('\0'));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

int limit(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

std::string resource_name(GLuint program, GLenum interface, GLuint index) {
  std::array<char, 256> text{};
  GLsizei length = 0;
  glGetProgramResourceName(program, interface, index, static_cast<GLsizei>(text.size()), &length, text.data());
  std::string name(text.data(), static_cast<std::size_t>(length));
  if (name.ends_with("[0]")) name.resize(name.size() - 3);
  return name;
}

}  // namespace

std::shared_ptr<GlProgram> GlProgram::compile(std::span<const ShaderSource> sources, std::string_view label) {
  std::vector<Shader> shaders;
  std::string errors;
  for (const ShaderSource& source : sources) {
    shaders.emplace_back(source);
    if (shaders.back().good()) continue;
    if (!errors.empty()) errors += '\n';
    errors +=
        fmt::format("shader '{}' does not compile:\n{}", source.name, name_files(shaders.back().log(), source.files));
  }
  if (!errors.empty()) fail("shader-compile", errors);

  std::shared_ptr<GlProgram> program(new GlProgram(glCreateProgram(), std::string(label)));
  glProgramParameteri(program->name_, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  for (const Shader& shader : shaders) glAttachShader(program->name_, shader.name());
  glLinkProgram(program->name_);
  for (const Shader& shader : shaders) glDetachShader(program->name_, shader.name());
  if (!linked(program->name_)) {
    std::string why = program_log(program->name_);
    if (why.empty()) why = "the driver gives no reason";
    fail(
        "shader-link", fmt::format("program '{}' does not link: {}", names(sources), why),
        "compare what one stage writes (out) with what the next reads (in), blocks declared in both, and the limits of "
        "the device");
  }
  program->introspect(sources.size() == 1 && sources.front().stage == GL_COMPUTE_SHADER);
  return program;
}

std::shared_ptr<GlProgram> GlProgram::restore(const ProgramBinary& binary, std::string_view label, bool compute) {
  std::shared_ptr<GlProgram> program(new GlProgram(glCreateProgram(), std::string(label)));
  glProgramBinary(program->name_, binary.format, binary.bytes.data(), static_cast<GLsizei>(binary.bytes.size()));
  if (!linked(program->name_)) return nullptr;
  program->introspect(compute);
  return program;
}

GlProgram::GlProgram(GlName name, std::string label)
    : name_(name), context_(current_context()), label_(std::move(label)) {
  gpu::label(GL_PROGRAM, name_, label_);
}

GlProgram::~GlProgram() {
  if (name_ && current_context() == context_) glDeleteProgram(name_);
}

ProgramBinary GlProgram::binary() const {
  ProgramBinary result;
  GLint length = 0;
  if (limit(GL_NUM_PROGRAM_BINARY_FORMATS) == 0) return result;
  glGetProgramiv(name_, GL_PROGRAM_BINARY_LENGTH, &length);
  if (length <= 0) return result;
  result.bytes.resize(static_cast<std::size_t>(length));
  GLsizei written = 0;
  glGetProgramBinary(name_, length, &written, &result.format, result.bytes.data());
  result.bytes.resize(static_cast<std::size_t>(std::max(written, 0)));
  return result;
}

void GlProgram::introspect(bool compute) {
  introspect_uniforms();
  introspect_blocks();
  // An error for any other program.
  if (compute) glGetProgramiv(name_, GL_COMPUTE_WORK_GROUP_SIZE, &local_size_.x);
}

void GlProgram::introspect_uniforms() {
  GLint count = 0;
  glGetProgramInterfaceiv(name_, GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
  int texture_units = 0, image_units = 0;
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    constexpr std::array<GLenum, 4> wanted{GL_BLOCK_INDEX, GL_TYPE, GL_LOCATION, GL_ARRAY_SIZE};
    std::array<GLint, 4> values{};
    glGetProgramResourceiv(name_, GL_UNIFORM, i, 4, wanted.data(), 4, nullptr, values.data());
    const auto [block, type, location, size] = values;
    if (block != -1 || location < 0) continue;  // member of a block, or of a counter
    ProgramInterface::Resource resource{resource_name(name_, GL_UNIFORM, i), location, static_cast<GLenum>(type)};
    uniforms_.emplace(resource.name, Uniform{location, resource.gl_type});
    const bool sampler = is_sampler_type(resource.gl_type);
    if (!sampler && !is_image_type(resource.gl_type)) {
      interface_.uniforms.push_back(std::move(resource));
      continue;
    }
    int& units = sampler ? texture_units : image_units;
    std::vector<GLint> unit(static_cast<std::size_t>(size));
    for (GLint& u : unit) u = units++;
    glProgramUniform1iv(name_, location, size, unit.data());
    resource.location_or_binding = unit.front();
    (sampler ? interface_.samplers : interface_.images).push_back(std::move(resource));
  }
  if (texture_units > limit(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS) || image_units > limit(GL_MAX_IMAGE_UNITS))
    fail("shader-limit", fmt::format("program '{}' uses {} textures and {} images; this device has {} and {} units",
                                     label_, texture_units, image_units, limit(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS),
                                     limit(GL_MAX_IMAGE_UNITS)));
}

void GlProgram::introspect_blocks() {
  const auto list = [&](GLenum interface, GLenum max, auto assign, std::vector<ProgramInterface::Resource>& into) {
    GLint count = 0;
    glGetProgramInterfaceiv(name_, interface, GL_ACTIVE_RESOURCES, &count);
    if (count > limit(max))
      fail("shader-limit", fmt::format("program '{}' uses {} {} blocks; this device binds {}", label_, count,
                                       interface == GL_UNIFORM_BLOCK ? "uniform" : "storage", limit(max)));
    for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
      assign(name_, i, i);
      into.push_back({resource_name(name_, interface, i), static_cast<int>(i), 0});
    }
  };
  list(
      GL_UNIFORM_BLOCK, GL_MAX_UNIFORM_BUFFER_BINDINGS,
      [](GLuint program, GLuint index, GLuint binding) { glUniformBlockBinding(program, index, binding); },
      interface_.uniform_blocks);
  list(
      GL_SHADER_STORAGE_BLOCK, GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS,
      [](GLuint program, GLuint index, GLuint binding) { glShaderStorageBlockBinding(program, index, binding); },
      interface_.storage_blocks);
}

const GlProgram::Uniform* GlProgram::find(std::string_view uniform) const {
  const auto it = uniforms_.find(uniform);
  return it == uniforms_.end() ? nullptr : &it->second;
}

// A scalar goes in as the type that the shader declares: a parameter that counts may be an int or a uint there.
template <class T>
void GlProgram::set_scalar(std::string_view uniform, T value) const {
  const Uniform* u = find(uniform);
  if (!u) return;
  switch (u->type) {
    case GL_FLOAT:
      return glProgramUniform1f(name_, u->location, static_cast<float>(value));
    case GL_UNSIGNED_INT:
      return glProgramUniform1ui(name_, u->location, static_cast<unsigned int>(value));
    default:
      return glProgramUniform1i(name_, u->location, static_cast<int>(value));
  }
}

void GlProgram::set(std::string_view uniform, int value) const { set_scalar(uniform, value); }
void GlProgram::set(std::string_view uniform, unsigned int value) const { set_scalar(uniform, value); }
void GlProgram::set(std::string_view uniform, float value) const { set_scalar(uniform, value); }
void GlProgram::set(std::string_view uniform, glm::vec2 value) const {
  if (const Uniform* u = find(uniform)) glProgramUniform2fv(name_, u->location, 1, &value.x);
}
void GlProgram::set(std::string_view uniform, glm::vec3 value) const {
  if (const Uniform* u = find(uniform)) glProgramUniform3fv(name_, u->location, 1, &value.x);
}
void GlProgram::set(std::string_view uniform, glm::vec4 value) const {
  if (const Uniform* u = find(uniform)) glProgramUniform4fv(name_, u->location, 1, &value.x);
}
void GlProgram::set(std::string_view uniform, glm::ivec2 value) const {
  if (const Uniform* u = find(uniform)) glProgramUniform2iv(name_, u->location, 1, &value.x);
}
void GlProgram::set(std::string_view uniform, glm::ivec3 value) const {
  if (const Uniform* u = find(uniform)) glProgramUniform3iv(name_, u->location, 1, &value.x);
}
void GlProgram::set(std::string_view uniform, const glm::mat4& value) const {
  if (const Uniform* u = find(uniform)) glProgramUniformMatrix4fv(name_, u->location, 1, GL_FALSE, &value[0].x);
}

bool is_shadow_sampler(unsigned int gl_type) {
  switch (gl_type) {
    case GL_SAMPLER_2D_SHADOW:
    case GL_SAMPLER_2D_ARRAY_SHADOW:
    case GL_SAMPLER_CUBE_SHADOW:
    case GL_SAMPLER_CUBE_MAP_ARRAY_SHADOW:
      return true;
    default:
      return false;
  }
}

bool is_sampler_type(unsigned int gl_type) {
  switch (gl_type) {
    case GL_SAMPLER_1D:
    case GL_SAMPLER_2D:
    case GL_SAMPLER_3D:
    case GL_SAMPLER_CUBE:
    case GL_SAMPLER_2D_ARRAY:
    case GL_SAMPLER_CUBE_MAP_ARRAY:
    case GL_SAMPLER_BUFFER:
    case GL_INT_SAMPLER_2D:
    case GL_INT_SAMPLER_3D:
    case GL_INT_SAMPLER_CUBE:
    case GL_INT_SAMPLER_2D_ARRAY:
    case GL_INT_SAMPLER_CUBE_MAP_ARRAY:
    case GL_INT_SAMPLER_BUFFER:
    case GL_UNSIGNED_INT_SAMPLER_2D:
    case GL_UNSIGNED_INT_SAMPLER_3D:
    case GL_UNSIGNED_INT_SAMPLER_CUBE:
    case GL_UNSIGNED_INT_SAMPLER_2D_ARRAY:
    case GL_UNSIGNED_INT_SAMPLER_CUBE_MAP_ARRAY:
    case GL_UNSIGNED_INT_SAMPLER_BUFFER:
      return true;
    default:
      return is_shadow_sampler(gl_type);
  }
}

bool is_image_type(unsigned int gl_type) {
  switch (gl_type) {
    case GL_IMAGE_2D:
    case GL_IMAGE_3D:
    case GL_IMAGE_CUBE:
    case GL_IMAGE_2D_ARRAY:
    case GL_IMAGE_CUBE_MAP_ARRAY:
    case GL_INT_IMAGE_2D:
    case GL_INT_IMAGE_3D:
    case GL_INT_IMAGE_CUBE:
    case GL_INT_IMAGE_2D_ARRAY:
    case GL_INT_IMAGE_CUBE_MAP_ARRAY:
    case GL_UNSIGNED_INT_IMAGE_2D:
    case GL_UNSIGNED_INT_IMAGE_3D:
    case GL_UNSIGNED_INT_IMAGE_CUBE:
    case GL_UNSIGNED_INT_IMAGE_2D_ARRAY:
    case GL_UNSIGNED_INT_IMAGE_CUBE_MAP_ARRAY:
      return true;
    default:
      return false;
  }
}

}  // namespace loom::gpu
