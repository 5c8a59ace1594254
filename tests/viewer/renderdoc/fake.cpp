// As much of RenderDoc as a program that takes a capture sees of it.
#include <renderdoc_app.h>

#include <cstdio>
#include <cstring>
#include <string>

namespace {

bool capturing = false;
std::uint32_t captures = 0;

void start(RENDERDOC_DevicePointer /*device*/, RENDERDOC_WindowHandle /*window*/) { capturing = true; }

std::uint32_t end(RENDERDOC_DevicePointer /*device*/, RENDERDOC_WindowHandle /*window*/) {
  capturing = false;
  ++captures;
  return 1;
}

std::uint32_t count() { return captures; }

std::uint32_t capture(std::uint32_t index, char* name, std::uint32_t* length, std::uint64_t* /*time*/) {
  if (index >= captures) return 0;
  const std::string path = "fake-" + std::to_string(index + 1) + ".rdc";
  if (length != nullptr) *length = static_cast<std::uint32_t>(path.size()) + 1;
  if (name != nullptr) std::memcpy(name, path.c_str(), path.size() + 1);
  return 1;
}

}  // namespace

extern "C" {
__attribute__((visibility("default"))) int fake_is_capturing() { return capturing ? 1 : 0; }

__attribute__((visibility("default"))) int RENDERDOC_GetAPI(RENDERDOC_Version version, void** out) {
  static RENDERDOC_API_1_1_2 api{};
  if (version != eRENDERDOC_API_Version_1_1_2) return 0;
  api.StartFrameCapture = start;
  api.EndFrameCapture = end;
  api.GetNumCaptures = count;
  api.GetCapture = capture;
  *out = &api;
  return 1;
}
}
