// The half of context.h that talks to EGL; its headers and those of the GL loader cannot be read in one file.
#include "gpu/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/core.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gpu/current.h"
#include "loom/diagnostic.h"

namespace loom::gpu {
namespace {

// Where a display may come from, and what to call it in an error.
struct Candidate {
  EGLDisplay display = EGL_NO_DISPLAY;
  std::string what;
};

bool has_extension(const char* extensions, std::string_view name) {
  if (!extensions) return false;
  return fmt::format(" {} ", extensions).find(fmt::format(" {} ", name)) != std::string::npos;
}

template <class F>
F egl_function(const char* name) {
  return reinterpret_cast<F>(eglGetProcAddress(name));
}

std::string egl_error() {
  switch (const EGLint code = eglGetError()) {
    case EGL_SUCCESS:
      return "no reason given";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH (no OpenGL 4.5 core)";
    default:
      return fmt::format("EGL error {:#x}", code);
  }
}

// Hardware first, by the order in which the driver lists it; then Mesa's surfaceless platform; then software devices.
std::vector<Candidate> candidates(std::string& tried) {
  std::vector<Candidate> hardware, software, result;
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto device_string = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (get_display && query_devices && device_string && has_extension(client, "EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i) {
      const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
      const char* extensions = device_string(device, EGL_EXTENSIONS);
      const bool is_software = has_extension(extensions, "EGL_MESA_device_software");
      const EGLDisplay display = get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
      const std::string what = fmt::format("EGL device {}{}", i, is_software ? " (software)" : "");
      if (display != EGL_NO_DISPLAY) (is_software ? software : hardware).push_back({display, what});
    }
    if (count == 0) tried += "\n  EGL device platform: no devices";
  } else {
    tried += "\n  EGL device platform: EGL_EXT_platform_device is not there";
  }
  result = std::move(hardware);
  if (get_display && has_extension(client, "EGL_MESA_platform_surfaceless")) {
    const EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY) result.push_back({display, "EGL surfaceless platform"});
  } else {
    tried += "\n  EGL surfaceless platform: EGL_MESA_platform_surfaceless is not there";
  }
  result.insert(result.end(), software.begin(), software.end());
  return result;
}

EGLContext create_on(const Candidate& candidate, std::string& tried) {
  const auto fail = [&](const std::string& why) {
    tried += fmt::format("\n  {}: {}", candidate.what, why);
    return EGL_NO_CONTEXT;
  };
  if (!eglInitialize(candidate.display, nullptr, nullptr)) return fail("cannot be initialised, " + egl_error());
  if (!eglBindAPI(EGL_OPENGL_API)) return fail("has no desktop OpenGL, " + egl_error());
  // No surface is ever drawn to, so that any config with OpenGL will do.
  constexpr std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLint count = 0;
  const bool found = eglChooseConfig(candidate.display, wanted.data(), &config, 1, &count) == EGL_TRUE && count > 0;
  const char* extensions = eglQueryString(candidate.display, EGL_EXTENSIONS);
  if (!found && !has_extension(extensions, "EGL_KHR_no_config_context")) return fail("has no config for OpenGL");
  if (!has_extension(extensions, "EGL_KHR_surfaceless_context")) return fail("needs a surface");
  constexpr std::array<EGLint, 7> attributes{
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  const EGLContext context =
      eglCreateContext(candidate.display, found ? config : EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
  if (context == EGL_NO_CONTEXT) return fail("gives no OpenGL 4.5 core context, " + egl_error());
  if (!eglMakeCurrent(candidate.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    const std::string why = egl_error();
    eglDestroyContext(candidate.display, context);
    return fail("the context cannot be made current, " + why);
  }
  return context;
}

}  // namespace

struct Context::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  // The display stays initialised: it is one object for the whole process, and terminating it would take every other
  // context on it (the embedding program's too) along.
  ~State() {
    if (context == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
  }
};

Context::Context(std::unique_ptr<State> state) : state_(std::move(state)) {}
Context::~Context() = default;
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;

Context Context::headless() {
  std::string tried;
  for (const Candidate& candidate : candidates(tried)) {
    auto state = std::make_unique<State>();
    state->display = candidate.display;
    state->context = create_on(candidate, tried);
    if (state->context == EGL_NO_CONTEXT) continue;
    require_current_context();
    return Context(std::move(state));
  }
  throw Error("no OpenGL 4.5 core context without a display. Tried:" + tried +
              "\n  A software driver comes with the packages libegl1 and libgl1-mesa-dri.");
}

void Context::make_current() const {
  eglBindAPI(EGL_OPENGL_API);
  if (!eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, state_->context))
    throw Error("the OpenGL context cannot be made current: " + egl_error());
}

void* current_context() {
  if (EGLContext context = eglGetCurrentContext(); context != EGL_NO_CONTEXT) return context;
  // A program with a GLX window: ask only where it has loaded the library itself, so that none is pulled in here.
  for (const char* name : {"libGLX.so.0", "libGL.so.1"}) {
    void* library = dlopen(name, RTLD_LAZY | RTLD_NOLOAD);
    if (!library) continue;
    const auto query = reinterpret_cast<void* (*)()>(dlsym(library, "glXGetCurrentContext"));
    void* context = query ? query() : nullptr;
    dlclose(library);
    if (context) return context;
  }
  return nullptr;
}

}  // namespace loom::gpu
