// Keeps every library loaded to the end of the process. GLFW unloads the window system's libraries; what those leave
// behind would then be reported as leaks of an unknown module, which no suppression can name.
#include <dlfcn.h>

extern "C" __attribute__((visibility("default"))) int dlclose(void* /*library*/) noexcept { return 0; }
