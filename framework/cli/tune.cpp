// loom tune: the cheapest pipeline that is accurate enough for a scene on this device, or the most accurate that is
// cheap enough.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/json_out.h"
#include "cli/progress.h"
#include "cli/sweep_run.h"
#include "core/image_io.h"
#include "measure/report/report.h"
#include "measure/sweep/measure_point.h"
#include "measure/sweep/truth.h"
#include "measure/tune/search.h"
#include "measure/tune/space.h"

namespace loom::cli {
namespace {

namespace fs = std::filesystem;
using measure::number_text;
using measure::Observation;
using measure::Promise;
using measure::Result;
using measure::Search;

/// A tenth of the grid, unless told otherwise; and a quarter more to find what twice as accurate costs.
constexpr std::size_t default_share = 10;
constexpr std::size_t share_for_twice = 4;

struct Arguments {
  SweepArguments sweep;
  std::string scene, out;
  Promise promise;
  std::size_t evaluations = 0;
};

std::string settings_text(const Result& r) {
  std::string text = r.pipeline;
  for (const auto& [param, value] : r.set) text += ' ' + param + '=' + value;
  return text;
}

std::string outcome_text(const Result& r) {
  return settings_text(r) + ": relMSE " + number_text(r.error("hdr")) + " in " + number_text(r.wall_ms.median) +
         " ms a frame";
}

Json outcome_json(const Result& r) {
  Json json = {{"pipeline", r.pipeline}, {"set", Json::object()}};
  for (const auto& [param, value] : r.set) json["set"][param] = Json::parse(value);
  const measure::OutputError& hdr = r.errors.at("hdr");
  json["hdr_relmse"] = hdr.relmse;
  json["ci95"] = {hdr.low, hdr.high};
  json["wall_ms"] = r.wall_ms.median;
  json["cpu_ms"] = r.cpu_ms.median;
  json["anew_ms"] = r.anew_ms;
  json["first_ms"] = r.first_ms;
  json["textures_bytes"] = r.bytes;
  return json;
}

class Job {
 public:
  Job(const Arguments& arguments, Session& session)
      : arguments_(arguments), session_(session), run_(arguments.sweep, session) {
    for (const measure::Point& point : run_.points()) results_.push_back(measure::describe(run_.sweep(), point));
  }

  void run() {
    run_.stage(run_.points());
    const std::size_t count = run_.points().size();
    const std::size_t allowed =
        arguments_.evaluations > 0 ? arguments_.evaluations : (count + default_share - 1) / default_share;
    const std::vector<measure::Candidate> candidates = measure::candidates_of(results_);
    Search found;
    look(candidates, arguments_.promise, allowed, found);
    const std::size_t seen = found.seen.size();
    if (!found.best) return refuse(found, seen);
    const Result& best = results_[*found.best];
    check_reference(best);

    // What was seen so far helps with twice the accuracy too.
    const Promise twice{.max_error = best.error("hdr") / 2, .budget_ms = {}};
    Search further{.seen = found.seen, .best = {}, .nearest = {}};
    look(candidates, twice, std::max<std::size_t>(1, allowed / share_for_twice), further);
    const std::optional<Result> better = further.best ? std::optional(results_[*further.best]) : std::nullopt;
    write(best, better, seen);
    tell(best, better, seen, further.seen.size());
  }

 private:
  void look(const std::vector<measure::Candidate>& candidates, const Promise& promise, std::size_t evaluations,
            Search& found) {
    Progress progress("setting", evaluations);
    std::uint64_t done = 0;
    measure::search(
        candidates, promise, evaluations,
        [&](std::size_t i) {
          const measure::Point& point = run_.points()[i];
          const std::optional<Result> kept = run_.kept(point);
          results_[i] = kept ? *kept : run_.measure_apart(point);
          progress.show(++done);
          const double error = results_[i].error("hdr");
          return Observation{.time_ms = results_[i].wall_ms.median,
                             .error = std::isfinite(error) ? error : std::numeric_limits<double>::infinity()};
        },
        found);
  }

  [[nodiscard]] std::string promise_text() const {
    const Promise& p = arguments_.promise;
    return p.max_error ? "a relMSE of " + number_text(*p.max_error) : number_text(*p.budget_ms) + " ms a frame";
  }

  void refuse(const Search& found, std::size_t seen) {
    Diagnostics findings;
    std::string hint = "none of them could be measured";
    if (found.nearest) hint = "the nearest is " + outcome_text(results_[*found.nearest]);
    findings.error("promise-not-kept",
                   "none of " + std::to_string(seen) + " settings tried, of " + std::to_string(results_.size()) +
                       ", keeps " + promise_text() + " on " + run_.sweep().scenes.front().name,
                   {}, hint);
    report(findings);
    if (session_.json) {
      Json document = versioned();
      document["kept"] = false;
      document["evaluations"] = seen;
      document["settings"] = results_.size();
      document["nearest"] = found.nearest ? outcome_json(results_[*found.nearest]) : Json(nullptr);
      document["diagnostics"] = to_json(findings);
      print(document);
    }
    session_.exit_code = 1;
  }

  /// A promise is worth no more than the reference that it was checked against.
  void check_reference(const Result& best) const {
    const double noise = run_.scenes().front().noise, error = best.error("hdr");
    if (noise * measure::truth_margin <= error) return;
    const double spp = run_.scenes().front().spp * noise * measure::truth_margin / error;
    throw Error([&] {
      Diagnostics findings;
      findings.error(
          "reference-too-noisy",
          "the reference has a relMSE of " + number_text(noise) + ", and " + settings_text(best) + " one of " +
              number_text(error) + " against it: it must be ten times below that",
          {}, "about --spp " + std::to_string(static_cast<long long>(std::ceil(1.25 * spp / 16)) * 16) + " would do");
      return findings;
    }());
  }

  void write(const Result& best, const std::optional<Result>& better, std::size_t seen) const {
    Json measured = {{"scene", best.scene}};
    if (arguments_.promise.max_error) measured["max_error"] = *arguments_.promise.max_error;
    if (arguments_.promise.budget_ms) measured["budget_ms"] = *arguments_.promise.budget_ms;
    measured["size"] = {best.size.x, best.size.y};
    measured["samples"] = best.samples;
    measured["static"] = best.keep_static;
    measured["result"] = outcome_json(best);
    measured["twice_as_accurate"] = better ? outcome_json(*better) : Json(nullptr);
    measured["settings_tried"] = seen;
    measured["settings"] = results_.size();
    measured["reference_relmse"] = run_.scenes().front().noise;
    measured["device"] = best.device;
    measured["program"] = best.version;
    const std::string text = text_of(measure::pipeline_of(best, arguments_.out, std::move(measured)));
    write_file_atomic(arguments_.out, std::as_bytes(std::span(text)));
  }

  void tell(const Result& best, const std::optional<Result>& better, std::size_t seen, std::size_t in_all) const {
    if (session_.json) {
      Json document = versioned();
      document["kept"] = true;
      document["output"] = arguments_.out;
      document["evaluations"] = seen;
      document["settings"] = results_.size();
      document["best"] = outcome_json(best);
      document["twice_as_accurate"] = better ? outcome_json(*better) : Json(nullptr);
      print(document);
      return;
    }
    const measure::OutputError& hdr = best.errors.at("hdr");
    std::printf("%s\n  keeps %s; 95 %% of the error: %s to %s\n", outcome_text(best).c_str(), promise_text().c_str(),
                number_text(hdr.low).c_str(), number_text(hdr.high).c_str());
    if (best.anew_ms > 0) std::printf("  everything anew: %s ms\n", number_text(best.anew_ms).c_str());
    if (better) {
      std::printf("  twice as accurate: %s, %s times the time\n", outcome_text(*better).c_str(),
                  number_text(better->wall_ms.median / best.wall_ms.median).c_str());
    } else {
      std::printf("  twice as accurate: nothing found among %zu settings tried\n", in_all);
    }
    std::printf("  %zu of %zu settings measured; written to %s\n", seen, results_.size(), arguments_.out.c_str());
  }

  const Arguments& arguments_;
  Session& session_;
  SweepRun run_;
  std::vector<Result> results_;  ///< by point; described only, until it is measured
};

void check(const Arguments& arguments) {
  if (arguments.promise.max_error.has_value() == arguments.promise.budget_ms.has_value()) {
    throw bad_usage("give either --max-error or --budget-ms", "for example --max-error 0.005");
  }
  const fs::path folder = fs::path(arguments.out).parent_path();
  if (!folder.empty() && !fs::is_directory(folder)) {
    throw bad_usage("-o " + arguments.out + ": there is no folder " + folder.string(), "make it first");
  }
  if (fs::path(arguments.out).extension() != ".json") {
    throw bad_usage("-o " + arguments.out + ": a pipeline is a .json", "for example -o best.json");
  }
}

}  // namespace

void add_tune(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("tune", "Find the cheapest pipeline that is accurate enough for a scene");
  const auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  command->add_option("scene", a.scene, "A .gltf, .glb or run file, or the name of a shipped one")
      ->default_str("cornell-box");
  command->add_option("--max-error", a.promise.max_error, "The most relMSE of hdr; the fastest that keeps it is found")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--budget-ms", a.promise.budget_ms,
                   "The most milliseconds a frame with all its samples takes; the most accurate that keeps it is found")
      ->check(CLI::PositiveNumber);
  command->add_option("-o,--out", a.out, "The pipeline to write (.json)")->required();
  command->add_option("--space", a.sweep.sweep,
                      "Sweep whose pipelines and grids are searched (default: the shipped full)");
  command->add_option("--evaluations", a.evaluations, "Settings to measure at most (default: a tenth of them)")
      ->check(CLI::PositiveNumber);
  command->add_option("--work", a.sweep.out, "Folder where measurements are kept (default: in the user's cache)")
      ->type_name("DIR");
  add_sweep_options(*command, a.sweep);
  add_json_option(*command, session);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] {
    check(*arguments);
    SweepArguments& sweep = arguments->sweep;
    sweep.no_flicker = true;  // it is no part of the promise
    sweep.scenes = {arguments->scene.empty() ? "cornell-box" : arguments->scene};
    if (sweep.sweep.empty())
      sweep.sweep = (fs::path(plugins::data_dir()) / "configs" / "sweeps" / "full.json").string();
    if (sweep.out.empty()) {
      sweep.out = (fs::path(measure::default_truth_folder()).parent_path() / "measurements").string();
    }
    Job(*arguments, session).run();
  });
}

}  // namespace loom::cli
