// loom view: the inspector. Its library, and with it a window system, is loaded here and nowhere else.
#include <dlfcn.h>

#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "core/data_dir.h"
#include "viewer/entry.h"

namespace loom::cli {
namespace {

void run(const CompileArguments& arguments, const Session& session) {
  viewer::Options options{.scene = find_scene(arguments.scene),
                          .pipeline = arguments.pipeline.empty() ? "" : find_pipeline(arguments.pipeline),
                          .camera = arguments.camera,
                          .surfaces = parse_surfaces(arguments.surfaces),
                          .set = parse_overrides(arguments.set),
                          .plugin_dirs = session.plugin_dirs,
                          .allow_outside = arguments.load.allow_outside};
  if (!arguments.size.empty()) options.size = parse_size(arguments.size);
  const std::string path = library_dir() + "/loom/" + viewer::library_name;
  // Never closed: the window system's libraries leave threads and handlers behind.
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  const auto open = library == nullptr ? nullptr : reinterpret_cast<viewer::Run>(dlsym(library, viewer::run_symbol));
  if (open == nullptr) {
    const char* reason = dlerror();
    Diagnostics diagnostics;
    diagnostics.error("no-inspector",
                      std::string("the inspector cannot be loaded: ") + (reason == nullptr ? "?" : reason),
                      {.file = path}, "`loom render -p PIPELINE -o out.png` draws without it");
    throw Error(diagnostics);
  }
  open(options);
}

}  // namespace

void add_view(CLI::App& app, Session& session) {
  auto* command =
      app.add_subcommand("view", "See every pass and texture of a pipeline, and change anything, in a window");
  const auto arguments = std::make_shared<CompileArguments>();
  add_scene_options(*command, *arguments);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
