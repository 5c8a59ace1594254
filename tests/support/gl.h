#pragma once
// One headless context for the test process.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gpu/context.h"
#include "gpu/device.h"
#include "support/temp_dir.h"

namespace loom::test {

/// The process's context, current from now on, or null where there is no OpenGL; `why` then says what was tried.
const gpu::Context* shared_context(std::string& why);

/// Shader roots of the source tree: shaders/.
std::vector<std::string> source_shader_roots();

/// Tests that need OpenGL. Skipped, loudly, where there is none.
class GlTest : public ::testing::Test {
 protected:
  void SetUp() override;
  /// Errors that OpenGL reported during the test fail it.
  void TearDown() override;
  /// A device over `dir()` (write_shader() puts files there) and shaders/, with no cache unless told.
  std::unique_ptr<gpu::CachingDevice> make_device(const std::string& cache_dir = "-") const;
  void write_shader(const std::string& name, const std::string& text) const { dir_.write(name, text); }
  [[nodiscard]] const TempDir& dir() const { return dir_; }

 private:
  TempDir dir_;
};

}  // namespace loom::test
