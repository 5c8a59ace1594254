#include "support/run_compute.h"

#include <epoxy/gl.h>

namespace loom::test {

void run_compute(const Program& program, const SceneView& scene, const Blocks& blocks, unsigned int groups) {
  const auto bind = [&](GLenum target, const ProgramInterface::Resource& resource) {
    const auto found = blocks.find(resource.name);
    const Buffer* buffer = found != blocks.end() ? found->second : scene.buffer(resource.name);
    ASSERT_NE(buffer, nullptr) << resource.name;
    glBindBufferBase(target, static_cast<GLuint>(resource.location_or_binding), buffer->name());
  };
  for (const auto& resource : program.interface().storage_blocks) bind(GL_SHADER_STORAGE_BUFFER, resource);
  for (const auto& resource : program.interface().uniform_blocks) bind(GL_UNIFORM_BUFFER, resource);
  for (const auto& resource : program.interface().samplers) {
    const Texture* texture = scene.texture(resource.name);
    ASSERT_NE(texture, nullptr) << resource.name;
    glBindTextureUnit(static_cast<GLuint>(resource.location_or_binding), texture->name());
  }
  glUseProgram(program.name());
  glDispatchCompute(groups, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

}  // namespace loom::test
