#pragma once
// The one log of the process, to stderr, so that stdout carries results alone.
#include <spdlog/logger.h>

#include "loom/export.h"

namespace loom {

/// Thread-safe. The command line sets its level (`-v`, `-q`); an embedding program may replace its sinks.
LOOM_API spdlog::logger& log();

}  // namespace loom
