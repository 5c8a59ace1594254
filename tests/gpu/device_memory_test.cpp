// A driver that runs out of memory in the middle of a frame.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "loom/diagnostic.h"
#include "support/render.h"

namespace loom {
namespace {

class DeviceMemory : public test::RenderTest {};

TEST_F(DeviceMemory, RunningOutInAFrameIsAClearError) {
  test::add_pass(registry_, "Hungry", [] {
    return test::PassFunctions{
        .reflect =
            [](Ports& ports) {
              ports.out("image", "Image")
                  .texture("image", TextureDesc::image(ports.frame_size(), Format::rgba16f), Access::image_write);
            },
        .execute =
            [](Frame&, const Bindings&) {
              // More than any device has, and no check of its own.
              GLuint buffer = 0;
              glCreateBuffers(1, &buffer);
              glNamedBufferStorage(buffer, GLsizeiptr{1} << 50, nullptr, 0);
              glDeleteBuffers(1, &buffer);
            },
    };
  });
  const auto renderer = make(R"({ "passes": { "h": { "type": "Hungry" } }, "outputs": { "image": "h.image" } })");
  try {
    frame(*renderer);
    FAIL() << "the frame was taken for good";
  } catch (const BadInput&) {
    FAIL() << "the user has nothing to mend";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnostics().all().front().code, "device-memory");
    EXPECT_THAT(error.diagnostics().all().front().hint, testing::HasSubstr("--max-memory"));
  }
}

}  // namespace
}  // namespace loom
