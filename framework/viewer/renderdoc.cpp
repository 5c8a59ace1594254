#include "viewer/renderdoc.h"

#include <dlfcn.h>
#include <renderdoc_app.h>

#include <cstdint>

#include "loom/diagnostic.h"

namespace loom::viewer {
namespace {

const RENDERDOC_API_1_1_2* api() {
  // Whoever injected the library keeps it: the handle only counts.
  void* library = dlopen("librenderdoc.so", RTLD_NOW | RTLD_NOLOAD);
  if (library == nullptr) return nullptr;
  const auto get = reinterpret_cast<pRENDERDOC_GetAPI>(dlsym(library, "RENDERDOC_GetAPI"));
  void* table = nullptr;
  const bool ok = get != nullptr && get(eRENDERDOC_API_Version_1_1_2, &table) == 1;
  dlclose(library);
  return ok ? static_cast<const RENDERDOC_API_1_1_2*>(table) : nullptr;
}

std::string newest_capture(const RENDERDOC_API_1_1_2& renderdoc) {
  const std::uint32_t count = renderdoc.GetNumCaptures();
  std::uint32_t length = 0;
  if (count == 0 || renderdoc.GetCapture(count - 1, nullptr, &length, nullptr) == 0 || length == 0) return {};
  std::string path(length, '\0');
  if (renderdoc.GetCapture(count - 1, path.data(), &length, nullptr) == 0) return {};
  path.resize(path.find('\0') == std::string::npos ? path.size() : path.find('\0'));
  return path;
}

}  // namespace

bool renderdoc_attached() { return api() != nullptr; }

std::string renderdoc_capture(const std::function<void()>& work) {
  const RENDERDOC_API_1_1_2* renderdoc = api();
  if (renderdoc == nullptr) throw Error("RenderDoc is not attached: start `loom view` from it");
  // Null names whatever device and window there are.
  renderdoc->StartFrameCapture(nullptr, nullptr);
  try {
    work();
  } catch (...) {
    renderdoc->EndFrameCapture(nullptr, nullptr);
    throw;
  }
  return renderdoc->EndFrameCapture(nullptr, nullptr) == 1 ? newest_capture(*renderdoc) : std::string();
}

}  // namespace loom::viewer
