// loom measure: a sweep of scenes, pipelines and parameters, each point in a process of its own, and the report of it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/json_out.h"
#include "cli/progress.h"
#include "cli/sweep_run.h"
#include "measure/report/report.h"
#include "measure/sweep/result.h"

namespace loom::cli {
namespace {

namespace fs = std::filesystem;
using measure::Point;

struct Arguments {
  SweepArguments sweep;
  std::string shard, point;
  std::vector<std::string> merge;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// "2/8" is the second of eight.
std::pair<int, int> parse_shard(const std::string& text) {
  int i = 0, n = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d/%d%c", &i, &n, &rest) != 2 || n < 1 || i < 1 || i > n) {
    throw bad_usage("--shard " + text + ": expected i/n, 1 <= i <= n", "for example --shard 2/8");
  }
  return {i, n};
}

/// What a run of this command came to.
struct Account {
  std::size_t failures = 0, missing = 0;
  double frames_s = 0, overhead_s = 0;  ///< of the points that were measured now
};

class Job {
 public:
  Job(const Arguments& arguments, Session& session)
      : arguments_(arguments), session_(session), run_(arguments.sweep, session) {}

  void measure_one() {
    const auto& points = run_.points();
    const auto found =
        std::find_if(points.begin(), points.end(), [&](const Point& p) { return p.key == arguments_.point; });
    if (found == points.end()) {
      throw bad_usage("--point " + arguments_.point + ": the sweep has no such point",
                      "its report names the key of each");
    }
    run_.measure_here(*found);
  }

  void measure_all() {
    std::vector<Point> share = run_.points();
    if (!arguments_.shard.empty()) {
      const auto [i, n] = parse_shard(arguments_.shard);
      share = measure::shard(run_.points(), i, n);
    }
    run_.stage(share);
    std::vector<Point> pending;
    for (const Point& point : share) {
      if (!run_.kept(point)) pending.push_back(point);
    }
    if (pending.size() < share.size()) {
      note(std::to_string(share.size() - pending.size()) + " of " + std::to_string(share.size()) +
           " points are measured already");
    }
    const auto start = std::chrono::steady_clock::now();
    double in_children_s = 0;
    {
      Progress progress("point", pending.size());
      std::uint64_t done = 0;
      for (const Point& point : pending) {
        const auto begun = std::chrono::steady_clock::now();
        run_.measure_apart(point);
        in_children_s += seconds_since(begun);
        progress.show(++done);
      }
    }
    report(pending, seconds_since(start) - in_children_s);
  }

  /// Takes what other folders hold of this sweep.
  void merge() {
    for (const std::string& folder : arguments_.merge) {
      std::size_t taken = 0;
      for (const Point& point : run_.points()) taken += take(folder, point) ? 1 : 0;
      note(folder + ": " + std::to_string(taken) + " of " + std::to_string(run_.points().size()) + " points");
      std::error_code ignored;
      fs::copy(fs::path(folder) / "scenes", fs::path(out()) / "scenes",
               fs::copy_options::skip_existing | fs::copy_options::recursive, ignored);
    }
    run_.read_scenes();
    report({}, 0);
  }

 private:
  [[nodiscard]] const std::string& out() const { return arguments_.sweep.out; }

  bool take(const std::string& folder, const Point& point) {
    const auto theirs = measure::read_result(folder, point.key);
    if (!theirs) return false;
    const auto ours = measure::read_result(out(), point.key);
    if (ours && ours->failure.empty()) return true;
    std::error_code error;
    for (const char* ending : {".png", ".error.png"}) {
      fs::copy_file(fs::path(folder) / "points" / (point.key + ending),
                    fs::path(run_.points_folder()) / (point.key + ending), fs::copy_options::overwrite_existing, error);
    }
    measure::write_result(out(), *theirs);
    return true;
  }

  void report(const std::vector<Point>& measured, double between_s) {
    measure::ReportData data{.folder = out(), .sweep = run_.sweep(), .results = {}, .scenes = run_.scenes()};
    data.expected = run_.points().size();
    data.version = program_version();
    data.command = [this](const std::string& key) { return run_.command(key); };
    std::set<std::string> fresh;
    for (const Point& point : measured) fresh.insert(point.key);
    Account account{.overhead_s = between_s};
    for (const Point& point : run_.points()) {
      const auto result = measure::read_result(out(), point.key);
      if (!result) {
        ++account.missing;
        continue;
      }
      if (!result->failure.empty()) {
        ++account.failures;
        note(result->pipeline + " on " + result->scene + " failed: " + result->failure);
      }
      if (fresh.contains(point.key)) {
        account.frames_s += result->frames_s;
        account.overhead_s += result->rest_s;
      }
      data.results.push_back(*result);
    }
    measure::write_report(data);
    tell(data, account);
  }

  void tell(const measure::ReportData& data, const Account& account) {
    Diagnostics findings;
    for (const measure::RefusedTruth& r : measure::refused_truths(data)) {
      findings.error("reference-too-noisy",
                     "the reference of " + r.scene + " has a relMSE of " + measure::number_text(r.noise) + ", " +
                         r.best + " one of " + measure::number_text(r.error) +
                         " against it: it must be ten times below that",
                     {data.sweep.file, 0, 0, {}}, "about --spp " + std::to_string(r.enough_spp) + " would do");
    }
    loom::cli::report(findings);
    if (session_.json) {
      Json document = versioned();
      document["report"] = data.folder;
      document["points"] = data.results.size();
      document["failed"] = account.failures;
      document["missing"] = account.missing;
      document["frames_s"] = account.frames_s;
      document["overhead_s"] = account.overhead_s;
      document["diagnostics"] = to_json(findings);
      print(document);
    } else {
      std::printf("%zu points, %zu failed, %zu not measured yet: %s\n", data.results.size(), account.failures,
                  account.missing, fs::absolute(fs::path(out()) / "index.html").lexically_normal().c_str());
      if (account.frames_s > 0) {
        std::printf("frames took %.1f s; reading back, comparing and keeping %.1f s more (%.1f %%)\n", account.frames_s,
                    account.overhead_s, 100 * account.overhead_s / account.frames_s);
      }
    }
    if (account.failures > 0 || findings.has_errors()) session_.exit_code = 1;
  }

  const Arguments& arguments_;
  Session& session_;
  SweepRun run_;
};

}  // namespace

void add_measure(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("measure", "Measure cost and error over a sweep, and write a report of it");
  const auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  command->add_option("sweep", a.sweep.sweep, "A sweep file (.json)")->required();
  command->add_option("-o,--out", a.sweep.out, "Folder of the report; a run that was stopped goes on in it")
      ->required();
  auto* share = command->add_option("--shard", a.shard, "Measure the i-th of n shares: --shard 2/8")->type_name("I/N");
  auto* merge =
      command->add_option("--merge", a.merge, "Measure nothing: take what these folders hold")->type_name("DIR");
  auto* point =
      command->add_option("--point", a.point, "Measure this point alone, in this process, even if it was before")
          ->type_name("KEY");
  merge->excludes(share)->excludes(point);
  point->excludes(share);
  command->add_option("--scene", a.sweep.scenes, "In place of the sweep's scenes; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--no-flicker", a.sweep.no_flicker, "Leave the camera path out");
  add_sweep_options(*command, a.sweep);
  add_json_option(*command, session);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] {
    Job job(*arguments, session);
    if (!arguments->point.empty()) {
      job.measure_one();
    } else if (!arguments->merge.empty()) {
      job.merge();
    } else {
      job.measure_all();
    }
  });
}

}  // namespace loom::cli
