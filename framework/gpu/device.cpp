#include "gpu/device.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/log.h"
#include "gpu/context.h"
#include "gpu/hash.h"
#include "gpu/program.h"
#include "gpu/program_cache.h"
#include "gpu/shader_source.h"
#include "loom/diagnostic.h"

namespace loom::gpu {
namespace {

// A program with a fragment stage alone draws one triangle that covers the target; on layered targets, one a layer
// (gl_Layer from the vertex stage is what every 4.5 driver of today offers, though core only later).
constexpr const char* fullscreen_vertex = R"(#version 450 core
#extension GL_ARB_shader_viewport_layer_array : enable
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
#ifdef GL_ARB_shader_viewport_layer_array
  gl_Layer = gl_InstanceID;
#endif
}
)";

std::string identity(const ProgramDesc& desc) {
  std::string text;
  for (const std::string& file : desc.files) text += file + '\n';
  for (const auto& [key, value] : desc.defines) text += key + '=' + value + '\n';
  return text;
}

std::string title(const ProgramDesc& desc) {
  std::string text;
  for (const std::string& file : desc.files) text += (text.empty() ? "" : " + ") + file;
  return text;
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return a == b || std::filesystem::equivalent(a, b, error);
}

class DeviceImpl final : public CachingDevice {
 public:
  explicit DeviceImpl(DeviceOptions options)
      : roots_(std::move(options.shader_roots)), cache_(options.cache_dir), description_(describe_device()) {}

  std::shared_ptr<const loom::Program> program(const ProgramDesc& desc) override {
    const std::string id = identity(desc);
    if (const auto it = programs_.find(id); it != programs_.end()) return it->second.program;
    const std::vector<ShaderSource> sources = load(desc);
    Entry entry{make(desc, sources), {}};
    for (const ShaderSource& source : sources) entry.files.insert(source.files.begin(), source.files.end());
    return programs_.emplace(id, std::move(entry)).first->second.program;
  }

  [[nodiscard]] std::string description() const override { return description_; }
  [[nodiscard]] ProgramStats stats() const override { return stats_; }

  [[nodiscard]] std::vector<std::string> sources_of(const loom::Program& program) const override {
    for (const auto& [id, entry] : programs_)
      if (entry.program.get() == &program) return {entry.files.begin(), entry.files.end()};
    return {};
  }

  [[nodiscard]] std::vector<std::string> sources() const override {
    std::set<std::string> files;
    for (const auto& [id, entry] : programs_) files.insert(entry.files.begin(), entry.files.end());
    return {files.begin(), files.end()};
  }

  void invalidate(const std::string& file) override {
    std::erase_if(programs_, [&](const auto& item) {
      const auto& files = item.second.files;
      return std::any_of(files.begin(), files.end(), [&](const std::string& f) { return same_file(f, file); });
    });
  }

 private:
  struct Entry {
    std::shared_ptr<const GlProgram> program;
    std::set<std::string> files;
  };

  [[nodiscard]] std::vector<ShaderSource> load(const ProgramDesc& desc) const {
    std::vector<ShaderSource> sources;
    if (desc.files.empty()) throw Error("a program needs at least one shader file");
    for (const std::string& file : desc.files) sources.push_back(load_shader(file, roots_, desc.defines));
    if (sources.size() == 1 && sources.front().stage == GL_FRAGMENT_SHADER)
      sources.push_back({.stage = GL_VERTEX_SHADER, .name = "full-screen triangle", .text = fullscreen_vertex});
    return sources;
  }

  std::shared_ptr<const GlProgram> make(const ProgramDesc& desc, const std::vector<ShaderSource>& sources) {
    Hash128 hash;
    hash.add(description_);
    for (const ShaderSource& source : sources) hash.add(std::to_string(source.stage)).add(source.text);
    const std::string key = hash.hex();
    if (const auto binary = cache_.load(key)) {
      const bool compute = sources.front().stage == GL_COMPUTE_SHADER;
      if (auto restored = GlProgram::restore(*binary, title(desc), compute)) {
        ++stats_.from_disk;
        return restored;
      }
    }
    const auto compiled = GlProgram::compile(sources, title(desc));
    ++stats_.compiled;
    if (const ProgramBinary binary = compiled->binary(); cache_.enabled() && !binary.bytes.empty())
      cache_.store(key, binary);
    return compiled;
  }

  std::vector<std::string> roots_;
  ProgramCache cache_;
  std::string description_;
  ProgramStats stats_;
  std::map<std::string, Entry> programs_;
};

}  // namespace

std::unique_ptr<CachingDevice> CachingDevice::create(DeviceOptions options) {
  require_current_context();
  return std::make_unique<DeviceImpl>(std::move(options));
}

}  // namespace loom::gpu
