#include "loom/plugin.h"

extern "C" __attribute__((visibility("default"))) const loom::LoomPlugin* loom_plugin() { return nullptr; }
