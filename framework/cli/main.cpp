// loom: dispatches to the subcommands and turns what they throw into messages and exit codes.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "cli/commands.h"
#include "cli/json_out.h"
#include "cli/session.h"
#include "loom/diagnostic.h"

namespace loom::cli {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_bad_input = 2;

using Add = void (*)(CLI::App&, Session&);
// NOLINTNEXTLINE(bugprone-macro-parentheses): the argument is pasted into a name
#define LOOM_COMMAND(name) &add_##name,
constexpr Add commands[] = {
#include "cli/commands.inc"
};
#undef LOOM_COMMAND

/// --json counts even where the rest of the command line cannot be understood.
bool wants_json(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--json") == 0) return true;
  }
  return false;
}

int fail(const Diagnostics& diagnostics, bool json, int code) {
  report(diagnostics);
  if (json) {
    Json document = versioned();
    document["diagnostics"] = to_json(diagnostics);
    print(document);
  }
  return code;
}

int fail(std::string code_name, std::string message, bool json, int code, std::string hint = {}) {
  Diagnostics diagnostics;
  diagnostics.error(std::move(code_name), std::move(message), {}, std::move(hint));
  return fail(diagnostics, json, code);
}

/// The innermost subcommand that was named, for the hint of a usage error.
std::string command_line_of(const CLI::App& app) {
  std::string text = app.get_name();
  for (const CLI::App* sub : app.get_subcommands()) text += " " + sub->get_name();
  return text;
}

int run(int argc, char** argv) {
  Session session;
  CLI::App app{"Lightloom: real-time global illumination, woven from passes, measured against the truth", "loom"};
  app.set_version_flag("--version", program_version());
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  for (const Add add : commands) add(app, session);

  const bool json = wants_json(argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return fail("usage", error.what(), json, exit_bad_input, "see " + command_line_of(app) + " --help");
  } catch (const BadInput& error) {
    return fail(error.diagnostics(), session.json, exit_bad_input);
  } catch (const Error& error) {
    return fail(error.diagnostics(), session.json, exit_failed);
  } catch (const std::bad_alloc&) {
    return fail("out-of-memory", "out of memory", session.json, exit_failed, "a smaller --size needs less");
  } catch (const std::exception& error) {
    return fail("failed", error.what(), session.json, exit_failed);
  }
  if (std::fflush(stdout) != 0) return exit_failed;
  return session.exit_code;
}

}  // namespace
}  // namespace loom::cli

int main(int argc, char** argv) { return loom::cli::run(argc, argv); }
