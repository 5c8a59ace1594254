#pragma once
// Where what is shipped beside the library lies: pipelines/, configs/, shaders/.
#include <string>

#include "loom/export.h"

namespace loom {

/// LOOM_DATA_DIR where it is set, else `<prefix>/share/loom` of the installation that this library is part of, else the
/// source tree of a build tree. Throws Error that names what was tried.
LOOM_API std::string data_dir();

}  // namespace loom
