#include "measure/tune/space.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

namespace loom::measure {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Numbers by size, before everything else, which stays in its order.
bool comes_before(const std::string& a, const std::string& b) {
  const Json x = Json::parse(a), y = Json::parse(b);
  return x.is_number() && (!y.is_number() || x.get<double>() < y.get<double>());
}

}  // namespace

std::vector<Candidate> candidates_of(const std::vector<Result>& points) {
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> values;  // by pipeline and knob
  for (const Result& point : points) {
    for (const auto& [knob, value] : point.set) {
      std::vector<std::string>& list = values[{point.pipeline, knob}];
      if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
    }
  }
  for (auto& [knob, list] : values) std::stable_sort(list.begin(), list.end(), comes_before);
  std::vector<Candidate> candidates;
  for (const Result& point : points) {
    Candidate candidate{.pipeline = point.pipeline, .knobs = {}};
    for (const auto& [knob, value] : point.set) {
      const std::vector<std::string>& list = values[{point.pipeline, knob}];
      if (list.size() < 2) continue;
      const auto rank = std::find(list.begin(), list.end(), value) - list.begin();
      candidate.knobs[knob] = static_cast<double>(rank) / static_cast<double>(list.size() - 1);
    }
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

Json pipeline_of(const Result& result, const std::string& path, Json measured) {
  const fs::path folder = fs::absolute(path).parent_path();
  const std::string name = fs::path(path).stem().string();
  Json json = {{"extends", fs::relative(fs::absolute(result.pipeline_path), folder).generic_string()},
               {"name", name},
               {"summary", result.pipeline + ", tuned by measurement for " + result.scene},
               {"measured", std::move(measured)}};
  Json& passes = json["passes"] = Json::object();
  for (const auto& [knob, value] : result.set) {
    const std::size_t dot = knob.find('.');
    passes[knob.substr(0, dot)]["params"][knob.substr(dot + 1)] = Json::parse(value);
  }
  return json;
}

}  // namespace loom::measure
