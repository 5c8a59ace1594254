#pragma once
// Where what is shipped beside the library lies (pipelines/, configs/, shaders/), and where a user's caches and state
// do.
#include <string>

#include "loom/export.h"

namespace loom {

/// The folder that holds libloom.so, links resolved; empty where it cannot be told.
LOOM_API std::string library_dir();
/// LOOM_DATA_DIR where it is set, else `<prefix>/share/loom` of the installation that this library is part of (in a
/// build tree a link to the sources). Throws Error that names what was tried.
LOOM_API std::string data_dir();
/// `lightloom` in XDG_CACHE_HOME, else in ~/.cache; empty where neither is set. May not exist yet.
LOOM_API std::string cache_dir();
/// The same of XDG_STATE_HOME, else ~/.local/state: what a program remembers from one run to the next.
LOOM_API std::string state_dir();

}  // namespace loom
