#include "loom/pass.h"

namespace loom {

// The vtables and typeinfo of the interfaces that plugins derive from live here, in the one shared library.
Pass::~Pass() = default;

}  // namespace loom
