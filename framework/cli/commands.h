#pragma once
// The subcommands. Each add_…() declares one with its options; its callback does the work, throws Error where it fails,
// and sets Session::exit_code where the work was done and the answer is no.
#include <CLI/CLI.hpp>

#include "cli/session.h"

namespace loom::cli {

// NOLINTNEXTLINE(bugprone-macro-parentheses): the argument is pasted into a name
#define LOOM_COMMAND(name) void add_##name(CLI::App& app, Session& session);
#include "cli/commands.inc"
#undef LOOM_COMMAND

}  // namespace loom::cli
