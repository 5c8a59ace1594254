#include "measure/report/front.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

namespace loom::measure {
namespace {

/// Below this an error is called the same, even where no seed changes anything.
constexpr double same = .02;

/// Numbers by size, false before true; nothing for what has no order.
std::optional<double> rank_of(const std::string& value) {
  const nlohmann::json json = nlohmann::json::parse(value, nullptr, false);
  if (json.is_number()) return json.get<double>();
  if (json.is_boolean()) return json.get<bool>() ? 1 : 0;
  return std::nullopt;
}

struct Step {
  double rank = 0;
  const Result* result = nullptr;
  std::string value;
};

/// By how much two errors may differ and still be called the same.
double slack(const Result& a, const Result& b) {
  const OutputError& ea = a.errors.at("hdr");
  const OutputError& eb = b.errors.at("hdr");
  return std::max(2 * (ea.seed_sd + eb.seed_sd), same * std::min(ea.relmse, eb.relmse));
}

/// Both a fall and a rise, each beyond what is called the same.
bool turns_back(const std::vector<Step>& steps) {
  bool falls = false, rises = false;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    for (std::size_t k = i + 1; k < steps.size(); ++k) {
      const double change = steps[k].result->error("hdr") - steps[i].result->error("hdr");
      const double allowed = slack(*steps[i].result, *steps[k].result);
      falls = falls || change < -allowed;
      rises = rises || change > allowed;
    }
  }
  return falls && rises;
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<double>& cost, const std::vector<double>& error) {
  std::vector<std::size_t> order(cost.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !std::isfinite(cost[i]) || !std::isfinite(error[i]); });
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(cost[a], error[a]) < std::pair(cost[b], error[b]); });
  std::vector<bool> front(cost.size(), false);
  double best = std::numeric_limits<double>::infinity();
  double best_cost = -1;
  for (const std::size_t i : order) {
    // Equals of a point on the front are on it too.
    if (error[i] < best || (error[i] == best && cost[i] == best_cost)) {
      front[i] = true;
      best = error[i];
      best_cost = cost[i];
    }
  }
  return front;
}

std::vector<double> round_steps(double low, double high) {
  std::vector<double> steps;
  if (!(low > 0) || !(high >= low)) return steps;
  for (int decade = static_cast<int>(std::floor(std::log10(low))); std::pow(10., decade) <= high; ++decade) {
    for (const double digit : {1., 2., 5.}) {
      // A negative power is divided by, so that .001 is the double that is written so.
      const double value = decade < 0 ? digit / std::pow(10., -decade) : digit * std::pow(10., decade);
      if (value >= low && value <= high) steps.push_back(value);
    }
  }
  return steps;
}

std::vector<OddKnob> odd_knobs(const std::vector<Result>& results) {
  // Every line through the grids along one knob.
  std::map<std::pair<std::string, std::string>, std::vector<Step>> lines;
  std::map<std::pair<std::string, std::string>, std::pair<std::string, std::string>> names;
  for (const Result& result : results) {
    if (!result.failure.empty() || !std::isfinite(result.error("hdr"))) continue;
    for (const auto& [param, value] : result.set) {
      const auto rank = rank_of(value);
      if (!rank) continue;
      std::string with;
      for (const auto& [other, held] : result.set) {
        if (other != param) with += (with.empty() ? "" : " ") + other + '=' + held;
      }
      const auto line = std::pair(result.scene + '\n' + result.pipeline, param + '\n' + with);
      lines[line].push_back({.rank = *rank, .result = &result, .value = value});
      names[line] = {param, with};
    }
  }
  std::vector<OddKnob> odd;
  for (auto& [line, steps] : lines) {
    std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.rank < b.rank; });
    if (steps.size() < 3 || !turns_back(steps)) continue;
    OddKnob knob{.scene = steps.front().result->scene, .pipeline = steps.front().result->pipeline};
    std::tie(knob.param, knob.with) = names[line];
    for (const Step& step : steps) {
      knob.values.push_back(step.value);
      knob.errors.push_back(step.result->error("hdr"));
      knob.keys.push_back(step.result->key);
    }
    odd.push_back(std::move(knob));
  }
  return odd;
}

}  // namespace loom::measure
