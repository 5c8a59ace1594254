#include "measure/stress_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "loom/diagnostic.h"

namespace loom::measure {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 4> outcomes{"held", "refused", "broken", "skipped"};

/// Rows or columns in the order in which they first appear.
std::size_t place(std::vector<std::string>& names, const std::string& name) {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) return static_cast<std::size_t>(it - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

std::string pipeline_name(const StressCase& c) { return std::filesystem::path(c.pipeline).stem().string(); }

std::string number(double value) { return value == 0 ? "0" : fmt::format("{:.1e}", value); }

std::string table_of_counts(const std::vector<StressCase>& cases, const StressLog& log) {
  std::vector<std::string> groups;
  std::vector<std::array<int, 4>> counts;
  std::array<int, 4> total{};
  for (const StressCase& c : cases) {
    const StressResult* result = log.find(c.id());
    if (result == nullptr) continue;
    const std::size_t row = place(groups, c.group);
    counts.resize(groups.size());
    ++counts[row][static_cast<std::size_t>(result->outcome)];
    ++total[static_cast<std::size_t>(result->outcome)];
  }
  std::string text = "| what is extreme | held | refused | broken | left out |\n|---|---|---|---|---|\n";
  const auto row = [&](const std::string& name, const std::array<int, 4>& n) {
    text += fmt::format("| {} | {} | {} | {} | {} |\n", name, n[0], n[1], n[2], n[3]);
  };
  for (std::size_t i = 0; i < groups.size(); ++i) row(groups[i], counts[i]);
  row("all", total);
  const auto tried = static_cast<std::size_t>(total[0] + total[1] + total[2] + total[3]);
  if (tried < cases.size())
    text += fmt::format("\n{} of {} cases; the rest has not been tried.\n", tried, cases.size());
  return text;
}

/// The largest error of each pipeline over the extremes of each law. Half is a law, half a measurement: what moves with
/// a grid has no bound but its own figure.
std::string table_of_laws(const std::vector<StressCase>& cases, const StressLog& log) {
  std::vector<std::string> laws, rows;
  std::vector<double> bounds;
  std::map<std::pair<std::size_t, std::size_t>, double> worst;
  for (const StressCase& c : cases) {
    const StressResult* result = log.find(c.id());
    if (result == nullptr || !std::isfinite(c.tolerance) || c.group == storage_group) continue;
    const std::size_t law = place(laws, c.group);
    bounds.resize(laws.size());
    bounds[law] = std::max(bounds[law], c.tolerance);
    const std::size_t row = place(rows, pipeline_name(c));
    if (result->outcome == StressOutcome::held || result->error > 0) {
      worst[{row, law}] = std::max(worst[{row, law}], result->error);
    }
  }
  std::string text = "| pipeline |";
  std::string line = "|---|";
  std::string allowed = "| *allowed* |";
  for (std::size_t i = 0; i < laws.size(); ++i) {
    text += fmt::format(" {} |", laws[i]);
    line += "---|";
    allowed += fmt::format(" {} |", number(bounds[i]));
  }
  text += "\n" + line + "\n" + allowed + "\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += fmt::format("| {} |", rows[r]);
    for (std::size_t i = 0; i < laws.size(); ++i) {
      const auto it = worst.find({r, i});
      text += it == worst.end() ? " – |" : fmt::format(" {} |", number(it->second));
    }
    text += "\n";
  }
  return text;
}

/// What half floats cost and save, volume by volume.
std::string table_of_storage(const std::vector<StressCase>& cases, const StressLog& log) {
  std::string text = "| pipeline | volumes of | relative L2 | memory saved, KiB |\n|---|---|---|---|\n";
  for (const StressCase& c : cases) {
    const StressResult* result = log.find(c.id());
    if (result == nullptr || c.group != storage_group) continue;
    text += fmt::format("| {} | {} | {} | {:.0f} |\n", pipeline_name(c), c.name, number(result->error),
                        result->saved / 1024);
  }
  return text;
}

/// How near the brightest texel of each group came to what physics allows.
std::string brightest(const std::vector<StressCase>& cases, const StressLog& log) {
  double share = 0;
  std::string where;
  for (const StressCase& c : cases) {
    const StressResult* result = log.find(c.id());
    // A sky that is seen is as bright as itself.
    if (result == nullptr || result->share <= share || c.name.find("sky") != std::string::npos) continue;
    share = result->share;
    where = c.id();
  }
  return fmt::format("The brightest picture reached {:.2g} of its furnace bound: `{}`.\n", share, where);
}

std::string list_of(const std::vector<StressCase>& cases, const StressLog& log, StressOutcome outcome) {
  std::map<std::string, std::vector<std::string>> by_message;
  for (const StressCase& c : cases) {
    const StressResult* result = log.find(c.id());
    if (result != nullptr && result->outcome == outcome) by_message[result->message].push_back(c.id());
  }
  std::string text;
  for (const auto& [message, ids] : by_message) {
    text += fmt::format("- {} ({}): `{}`{}\n", message, ids.size(), ids.front(), ids.size() > 1 ? " and others" : "");
  }
  return text.empty() ? "Nothing.\n" : text;
}

}  // namespace

std::string to_line(const std::string& id, const StressResult& result) {
  const json line{{"id", id},
                  {"outcome", outcomes[static_cast<std::size_t>(result.outcome)]},
                  {"message", result.message},
                  {"error", result.error},
                  {"share", result.share},
                  {"saved", result.saved}};
  return line.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::optional<std::pair<std::string, StressResult>> from_line(const std::string& line) {
  const json value = json::parse(line, nullptr, false);
  if (!value.is_object()) return std::nullopt;
  try {
    const auto name = std::find(outcomes.begin(), outcomes.end(), value.at("outcome").get<std::string>());
    if (name == outcomes.end()) return std::nullopt;
    // A number that is not finite was written as null.
    const auto read = [&](const char* key) { return value.at(key).is_number() ? value.at(key).get<double>() : 0; };
    return std::pair(value.at("id").get<std::string>(),
                     StressResult{.outcome = static_cast<StressOutcome>(name - outcomes.begin()),
                                  .message = value.at("message").get<std::string>(),
                                  .error = read("error"),
                                  .share = read("share"),
                                  .saved = read("saved")});
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

StressLog::StressLog(std::string path) : path_(std::move(path)) {
  std::ifstream file(path_);
  for (std::string line; std::getline(file, line);) {
    if (auto known = from_line(line)) results_.insert_or_assign(known->first, known->second);
  }
}

const StressResult* StressLog::find(const std::string& id) const {
  const auto it = results_.find(id);
  return it == results_.end() ? nullptr : &it->second;
}

void StressLog::add(const StressCase& what, const StressResult& result) {
  results_.insert_or_assign(what.id(), result);
  if (path_.empty()) return;
  std::ofstream file(path_, std::ios::app);
  // A line that was cut off ends here.
  file << "\n" << to_line(what.id(), result);
  file.close();
  if (!file) throw Error("cannot write " + path_);
}

std::string stress_report(const std::vector<StressCase>& cases, const StressLog& log) {
  return R"(# Stability at the extremes

Written by `loom stress -o docs/stability.md --state FILE`, which generates its cases from the pipelines and from the
declared ranges of their parameters. Every case must end in a picture, or in a clear error before the first frame. In a
picture every number that any pass makes is finite, no light is negative, and nothing is brighter than the furnace bound
`(L_e + ρ/π·E) / (1 − ρ)` of the scene: its largest emission, albedo and straight irradiance. Transients
are filled with NaN before each frame. Cases run in processes of their own, so that a crash or a hang is a result too; on
16×12 pixels of a closed room, with grids of 4 cells a side and maps as small unless they are what is stretched.

- *A parameter at an end*, *two parameters of a pass at their ends*: the declared ends.
- *All parameters at their ends*: rows that set every parameter of the pipeline, so chosen that every two values of any two
  parameters meet in one; counts end at 8 there.

)" + table_of_counts(cases, log) +
         "\n" + brightest(cases, log) + R"(
## The precision that is kept

Relative L2 by which each law is missed, the worst over the extremes that were tried, of `hdr` and of `indirect`, the larger.

- *Light ×k = picture ×k*: 1e-8 … 1e8. *Units*: the room at 1e-3 … 1e6 of its size, lights with the square of it.
- *Far from the origin*: 1.5e6 m away. *A + B*: a lamp and a light together, and each alone.
- *A quarter turn* of everything moves random directions and, where the room is no cube, cells: noise and a grid's own
  error show. *Small steps* show how far a picture follows its grid: a light that moves by 3 cm (its straight light
  changes too: the row `direct`), a camera that moves sideways by one pixel, compared at the same points of the world.

)" + table_of_laws(cases, log) +
         R"(
## Half floats against floats

`storage = fp16` of one pass against `fp32`, everything else as the pipeline has it: what the picture loses, and the memory
that the plan saves. Half floats keep 11 bits (4.9e-4) and hold at most 65504 of a unit; more is held there, so that it stays finite.

)" + table_of_storage(cases, log) +
         "\n## Broken\n\n" + list_of(cases, log, StressOutcome::broken) + "\n## Refused before the first frame\n\n" +
         list_of(cases, log, StressOutcome::refused) + "\n## Left out for memory or time\n\n" +
         list_of(cases, log, StressOutcome::skipped);
}

}  // namespace loom::measure
