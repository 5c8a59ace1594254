#include "support/gl.h"

#include <epoxy/gl.h>

#include <optional>
#include <utility>

#include "loom/diagnostic.h"
#include "support/user_cache.h"

namespace loom::test {

namespace {

struct Shared {
  std::optional<gpu::Context> context;
  std::string why;
  Shared() {
    isolate_user_cache();
    try {
      context = gpu::Context::headless();
    } catch (const Error& error) {
      why = error.what();
    }
  }
};

std::optional<Shared>& shared() {
  static std::optional<Shared> made;
  return made;
}

// The context goes when the tests are over, not among the destructors of static objects: those of the driver, of LLVM
// and of the log run in an order that depends on what was first used when, and a context needs all three to the end.
class ContextEnvironment : public ::testing::Environment {
 public:
  void TearDown() override { shared().reset(); }
};

[[maybe_unused]] const ::testing::Environment* const environment =
    ::testing::AddGlobalTestEnvironment(new ContextEnvironment);  // GoogleTest deletes it

}  // namespace

const gpu::Context* shared_context(std::string& why) {
  if (!shared()) shared().emplace();
  why = shared()->why;
  if (!shared()->context) return nullptr;
  shared()->context->make_current();
  return &*shared()->context;
}

std::vector<std::string> source_shader_roots() { return {LOOM_SOURCE_DIR "/shaders"}; }

void GlTest::SetUp() {
  std::string why;
  if (!shared_context(why)) GTEST_SKIP() << "no OpenGL here, so nothing that draws is tested: " << why;
}

void GlTest::TearDown() {
  std::string why;
  if (IsSkipped() || !shared_context(why)) return;
  glFinish();  // what a test has begun ends in that test
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError())
    ADD_FAILURE() << "OpenGL error " << error << " was left behind (see the log)";
}

std::unique_ptr<gpu::CachingDevice> GlTest::make_device(const std::string& cache_dir) const {
  std::vector<std::string> roots{dir_.path()};
  for (std::string& root : source_shader_roots()) roots.push_back(std::move(root));
  return gpu::CachingDevice::create({.shader_roots = roots, .cache_dir = cache_dir});
}

}  // namespace loom::test
