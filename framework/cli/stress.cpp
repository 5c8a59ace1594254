// loom stress: pushes every pipeline to the ends of what it accepts, and writes down what held.
#include <cstdint>
#include <cstdio>
#include <memory>
#include <regex>
#include <span>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/progress.h"
#include "cli/stress_child.h"
#include "core/image_io.h"
#include "measure/stress.h"
#include "measure/stress_report.h"

namespace loom::cli {
namespace {

struct Arguments {
  std::vector<std::string> pipelines;
  std::string filter, state, out;
  double seconds = 60;
  std::uint64_t max_memory = std::uint64_t{512} << 20;
  bool list = false, quick = false;
};

void run(const Arguments& arguments, Session& session) {
  const Registry registry = load_registry(session);
  std::vector<std::string> pipelines;
  for (const std::string& name : arguments.pipelines.empty() ? shipped_pipelines() : arguments.pipelines) {
    pipelines.push_back(find_pipeline(name));
  }
  std::vector<measure::StressCase> cases = measure::stress_cases(pipelines, registry);
  std::regex wanted;
  try {
    wanted = std::regex(arguments.filter);
  } catch (const std::regex_error& error) {
    throw bad_usage("--filter " + arguments.filter + ": " + error.what());
  }
  std::erase_if(cases, [&](const measure::StressCase& c) {
    return !std::regex_search(c.id(), wanted) || (arguments.quick && !c.quick);
  });
  if (arguments.list) {
    for (const measure::StressCase& c : cases) std::printf("%s\n", c.id().c_str());
    return;
  }

  measure::StressLog done(arguments.state);
  std::vector<const measure::StressCase*> open;
  for (const measure::StressCase& c : cases) {
    if (done.find(c.id()) == nullptr) open.push_back(&c);
  }
  Progress progress("case", cases.size());
  std::uint64_t count = cases.size() - open.size();
  run_in_children(open, registry, session.search(), {.bytes = arguments.max_memory}, arguments.seconds,
                  [&](const measure::StressCase& c, const measure::StressResult& result) {
                    done.add(c, result);
                    progress.show(++count);
                  });
  std::size_t broken = 0;
  for (const measure::StressCase& c : cases) {
    const measure::StressResult& result = *done.find(c.id());
    if (result.outcome != measure::StressOutcome::broken) continue;
    ++broken;
    std::fprintf(stderr, "broken: %s: %s\n", c.id().c_str(), result.message.c_str());
  }
  const std::string text = measure::stress_report(cases, done);
  if (arguments.out.empty()) {
    std::fwrite(text.data(), 1, text.size(), stdout);
  } else {
    write_file_atomic(arguments.out, std::as_bytes(std::span(text)));
  }
  if (broken > 0) session.exit_code = 1;
}

}  // namespace

void add_stress(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("stress", "Push pipelines to the extremes and report what holds");
  const auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  command->add_option("pipelines", a.pipelines, "Pipelines; default: all that are shipped");
  command->add_option("-o,--out", a.out, "Write the report (Markdown) to this file; default: stdout");
  command->add_option("--state", a.state, "Keep results in this file and go on from there");
  command->add_option("--filter", a.filter, "Only cases whose name matches this regular expression");
  command->add_flag("--quick", a.quick, "Only the part that the tests run");
  command->add_flag("--list", a.list, "Print the names of the cases");
  command->add_option("--seconds", a.seconds, "Time for one case")
      ->check(CLI::Range(1., 86400.))
      ->capture_default_str();
  command->add_option("--max-memory", a.max_memory, "Skip plans that take more bytes (K, M, G: powers of 1024)")
      ->transform(CLI::AsSizeValue(false));
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
