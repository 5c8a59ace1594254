#include "measure/report/report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <tuple>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/data_dir.h"
#include "core/image_io.h"
#include "loom/diagnostic.h"
#include "measure/report/front.h"

namespace loom::measure {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void write_text(const fs::path& path, const std::string& text) {
  write_file_atomic(path.string(), std::as_bytes(std::span(text)));
}

std::string text_of(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// "lpv · lpv.iterations=8": a point as people call it.
std::string label_of(const Result& result) {
  std::string label = result.pipeline;
  for (const auto& [param, value] : result.set) label += ' ' + param + '=' + value;
  return label;
}

/// One word of a shell's command line.
std::string quoted(const std::string& word) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + '\'';
}

/// A value as --set takes it: a string without its quotes.
std::string argument_of(const std::string& value) {
  const Json json = Json::parse(value, nullptr, false);
  return json.is_string() ? json.get<std::string>() : value;
}

/// The picture again, bit for bit: the frames that were measured, and the one before them.
std::string render_command(const ReportData& data, const Result& r) {
  const auto scene = std::find_if(data.sweep.scenes.begin(), data.sweep.scenes.end(),
                                  [&](const SweepScene& s) { return s.name == r.scene && s.camera == r.camera; });
  std::string text = "loom render";
  if (scene != data.sweep.scenes.end()) text += ' ' + quoted(fs::exists(scene->name) ? scene->path : scene->name);
  text += " -p " + quoted(r.pipeline) +
          fmt::format(" --size {}x{} --samples {} --frames {} --dt 0", r.size.x, r.size.y, r.samples, r.frames + 1);
  if (!r.camera.empty()) text += " --camera " + quoted(r.camera);
  for (const auto& [param, value] : r.set) text += " --set " + quoted(param + '=' + argument_of(value));
  if (!r.keep_static) text += " --no-prune=static";
  return text + " -o " + r.key + ".exr";
}

std::string measure_command(const ReportData& data, const Result& r) {
  std::string text = "loom";
  for (const std::string& word : data.command(r.key)) text += ' ' + quoted(word);
  return text;
}

bool measured(const Result& r) { return r.failure.empty() && std::isfinite(r.error("hdr")); }

/// The points of each scene, in the order in which the sweep has the scenes.
std::vector<std::vector<const Result*>> by_scene(const ReportData& data) {
  std::vector<std::vector<const Result*>> groups;
  for (const SweepScene& scene : data.sweep.scenes) {
    std::vector<const Result*> group;
    for (const Result& r : data.results) {
      if (r.scene == scene.name && r.camera == scene.camera && measured(r)) group.push_back(&r);
    }
    if (!group.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

/// The best that each pipeline of a scene reaches within each bound: of `value`, where `bounded` is at most the bound.
Json best_within(const std::vector<const Result*>& group, const std::vector<double>& bounds, const auto& bounded,
                 const auto& value) {
  std::vector<std::string> pipelines;
  for (const Result* r : group) {
    if (std::find(pipelines.begin(), pipelines.end(), r->pipeline) == pipelines.end()) pipelines.push_back(r->pipeline);
  }
  Json rows = Json::array();
  for (const std::string& pipeline : pipelines) {
    Json cells = Json::array();
    for (const double bound : bounds) {
      const Result* best = nullptr;
      for (const Result* r : group) {
        if (r->pipeline != pipeline || bounded(*r) > bound) continue;
        if (best == nullptr || value(*r) < value(*best)) best = r;
      }
      cells.push_back(best == nullptr ? Json(nullptr) : Json{{"value", value(*best)}, {"key", best->key}});
    }
    rows.push_back({{"pipeline", pipeline}, {"cells", cells}});
  }
  return {{"bounds", bounds}, {"rows", rows}};
}

Json tables(const std::vector<const Result*>& group) {
  const auto time = [](const Result& r) { return r.wall_ms.median; };
  const auto error = [](const Result& r) { return r.error("hdr"); };
  const auto range = [&](const auto& of) {
    double low = of(*group.front()), high = low;
    for (const Result* r : group) {
      low = std::min(low, of(*r));
      high = std::max(high, of(*r));
    }
    return round_steps(low, high * 2);
  };
  return {{"error_at_time", best_within(group, range(time), time, error)},
          {"time_at_error", best_within(group, range(error), error, time)}};
}

Json scene_json(const SceneReport& scene, const std::vector<const Result*>& group) {
  const auto errors = [](const TruthErrors& e) {
    return Json{{"hdr", e.hdr}, {"indirect", e.indirect}, {"bounce", e.bounce}};
  };
  Json json = {{"name", scene.name},
               {"camera", scene.camera},
               {"size", {scene.size.x, scene.size.y}},
               {"samples", scene.samples},
               {"picture", scene_stem(scene) + ".png"},
               {"reference", {{"spp", scene.spp}, {"seconds", scene.seconds}, {"noise_relmse", scene.noise}}},
               {"without_indirect_relmse", errors(scene.without_indirect)},
               {"aliasing_relmse", scene.aliasing}};
  Json& curve = json["reference"]["convergence"] = Json::array();
  for (const Truth::Step& s : scene.convergence) {
    curve.push_back({{"spp", s.spp}, {"seconds", s.seconds}, {"relmse", s.relmse}});
  }
  if (!group.empty()) json["tables"] = tables(group);
  return json;
}

Json odd_json(const std::vector<Result>& results) {
  Json list = Json::array();
  for (const OddKnob& knob : odd_knobs(results)) {
    list.push_back({{"scene", knob.scene},
                    {"pipeline", knob.pipeline},
                    {"param", knob.param},
                    {"with", knob.with},
                    {"values", knob.values},
                    {"errors", knob.errors},
                    {"keys", knob.keys}});
  }
  return list;
}

Json report_json(const ReportData& data) {
  Json json = {{"version", 1},
               {"name", data.sweep.name},
               {"summary", data.sweep.summary},
               {"sweep", data.sweep.file},
               {"expected", data.expected},
               {"program", data.version}};
  std::set<std::string> devices, programs;
  for (const Result& r : data.results) {
    if (!r.device.empty()) devices.insert(r.device);
    if (!r.version.empty()) programs.insert(r.version);
  }
  json["devices"] = devices;
  json["programs"] = programs;  // more than one: not all points are of one build
  json["static"] = data.sweep.settings.keep_static;
  Json& refused = json["refused_references"] = Json::array();
  for (const RefusedTruth& r : refused_truths(data)) {
    refused.push_back({{"scene", r.scene},
                       {"best", r.best},
                       {"noise_relmse", r.noise},
                       {"best_relmse", r.error},
                       {"enough_spp", r.enough_spp}});
  }
  const auto groups = by_scene(data);
  std::map<std::string, bool> front;
  for (const auto& group : groups) {
    std::vector<double> cost, error;
    for (const Result* r : group) {
      cost.push_back(r->wall_ms.median);
      error.push_back(r->error("hdr"));
    }
    const std::vector<bool> on = pareto_front(cost, error);
    for (std::size_t i = 0; i < group.size(); ++i) front[group[i]->key] = on[i];
  }
  Json& scenes = json["scenes"] = Json::array();
  for (const SweepScene& scene : data.sweep.scenes) {
    for (const SceneReport& report : data.scenes) {
      if (report.name != scene.name || report.camera != scene.camera) continue;
      const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
        return g.front()->scene == report.name && g.front()->camera == report.camera;
      });
      scenes.push_back(scene_json(report, group == groups.end() ? std::vector<const Result*>() : *group));
      break;
    }
  }
  json["odd_knobs"] = odd_json(data.results);
  Json& points = json["points"] = Json::array();
  for (const Result& r : data.results) {
    Json point = to_json(r);
    point["label"] = label_of(r);
    if (measured(r)) {
      point["front"] = front[r.key];
      point["picture"] = "points/" + r.key + ".png";
      point["heatmap"] = "points/" + r.key + ".error.png";
    }
    point["commands"] = {{"measure", measure_command(data, r)}, {"render", render_command(data, r)}};
    points.push_back(std::move(point));
  }
  return json;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
  return cell + '"';
}

std::string csv(const ReportData& data) {
  std::string text =
      "key,scene,pipeline,set,front,wall_ms,wall_p95_ms,cpu_ms,cpu_p95_ms,gpu_ms,gpu_p95_ms,first_ms,anew_ms,textures_"
      "bytes,"
      "hdr_relmse,hdr_low,hdr_high,indirect_relmse,indirect_low,indirect_high,bounce_relmse,bounce_low,bounce_high,"
      "indirect_mean_ratio,indirect_flip,flicker,failure\n";
  const Json report = report_json(data);
  for (std::size_t i = 0; i < data.results.size(); ++i) {
    const Result& r = data.results[i];
    std::string set;
    for (const auto& [param, value] : r.set) set += (set.empty() ? "" : " ") + param + '=' + value;
    const bool front = report["points"][i].value("front", false);
    text += fmt::format("{},{},{},{},{}", r.key, csv_cell(r.scene), csv_cell(r.pipeline), csv_cell(set), front ? 1 : 0);
    text += fmt::format(",{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{}", r.wall_ms.median, r.wall_ms.p95,
                        r.cpu_ms.median, r.cpu_ms.p95, r.gpu_ms.median, r.gpu_ms.p95, r.first_ms, r.anew_ms, r.bytes);
    for (const char* output : {"hdr", "indirect", "bounce"}) {
      const auto found = r.errors.find(output);
      if (found == r.errors.end()) {
        text += ",,,";
      } else {
        text += fmt::format(",{:.6g},{:.6g},{:.6g}", found->second.relmse, found->second.low, found->second.high);
      }
    }
    const auto indirect = r.errors.find("indirect");
    text += indirect == r.errors.end()
                ? ",,"
                : fmt::format(",{:.6g},{:.6g}", indirect->second.mean_ratio, indirect->second.flip.value_or(0));
    text += (r.flicker ? fmt::format(",{:.6g},", *r.flicker) : ",,") + csv_cell(r.failure) + '\n';
  }
  return text;
}

/// Rows for a page: one a point, scenes in the sweep's order, pipelines in the order of its entries.
std::string markdown(const ReportData& data) {
  std::string text =
      "| scene | pipeline | hdr relMSE (95 %) | indirect relMSE | mean ratio | FLIP | flicker | frame, ms | CPU, ms | "
      "all anew, ms | memory, MiB |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  const auto rank = [&](const Result* r) {
    const auto& entries = data.sweep.pipelines;
    return std::find_if(entries.begin(), entries.end(), [&](const SweepEntry& e) { return e.name == r->pipeline; }) -
           entries.begin();
  };
  for (std::vector<const Result*> group : by_scene(data)) {
    std::stable_sort(group.begin(), group.end(), [&](auto* a, auto* b) { return rank(a) < rank(b); });
    for (const Result* r : group) {
      const OutputError& hdr = r->errors.at("hdr");
      const OutputError& indirect = r->errors.at("indirect");
      text +=
          fmt::format("| {} | {} | {:.3g} ({:.2g}–{:.2g}) | {:.3g} | {:.2f} | {:.3f} | {} | {} | {} | {} | {:.1f} |\n",
                      r->scene, label_of(*r), hdr.relmse, hdr.low, hdr.high, indirect.relmse, indirect.mean_ratio,
                      indirect.flip.value_or(0), r->flicker ? fmt::format("{:.3f}", *r->flicker) : "–",
                      number_text(r->wall_ms.median), number_text(r->cpu_ms.median),
                      r->anew_ms > 0 ? number_text(r->anew_ms) : "–", static_cast<double>(r->bytes) / 1048576);
    }
  }
  for (const SceneReport& scene : data.scenes) {
    text += fmt::format(
        "\n{}: {}×{}, {} samples a pixel. Reference: {} paths a pixel in {:.0f} s, its own relMSE {:.2g}. Sampling "
        "alone "
        "costs a relMSE of {:.2g}; no indirect light at all {:.3g}.\n",
        scene.name, scene.size.x, scene.size.y, scene.samples, scene.spp, scene.seconds, scene.noise, scene.aliasing,
        scene.without_indirect.hdr);
  }
  std::set<std::string> devices;
  for (const Result& r : data.results) {
    if (!r.device.empty()) devices.insert(r.device);
  }
  for (const std::string& device : devices) text += "\nDevice: " + device + ".\n";
  return text;
}

}  // namespace

std::vector<RefusedTruth> refused_truths(const ReportData& data) {
  std::vector<RefusedTruth> refused;
  for (const SceneReport& scene : data.scenes) {
    const Result* best = nullptr;
    for (const Result& r : data.results) {
      if (r.truth != scene.truth || r.scene != scene.name || !measured(r)) continue;
      if (best == nullptr || r.error("hdr") < best->error("hdr")) best = &r;
    }
    if (best == nullptr || scene.noise * truth_margin <= best->error("hdr")) continue;
    // The error falls with the samples; what the reference adds to the method's falls too, so that a little more is
    // asked.
    const double more = 1.25 * truth_margin * scene.noise / best->error("hdr");
    refused.push_back({.scene = scene.name,
                       .best = label_of(*best),
                       .noise = scene.noise,
                       .error = best->error("hdr"),
                       .enough_spp = static_cast<std::uint64_t>(std::ceil(scene.spp * more / 16)) * 16});
  }
  return refused;
}

std::string number_text(double value) {
  return value < 999.5 || value >= 1e6 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

void write_report(const ReportData& data) {
  const fs::path folder = data.folder;
  const fs::path assets = fs::path(data_dir()) / "configs" / "report";
  for (const char* name : {"index.html", "report.css", "report.js", "chart.umd.js", "chart.umd.LICENSE.md"}) {
    std::error_code error;
    fs::copy_file(assets / name, folder / name, fs::copy_options::overwrite_existing, error);
    if (error) throw Error("the report cannot be written: " + (assets / name).string() + ": " + error.message());
  }
  const Json report = report_json(data);
  write_text(folder / "report.json", text_of(report));
  // A page from disk may load scripts but not read files: the same once more, as a script.
  write_text(folder / "data.js", "window.loom_report = " + text_of(report, -1));
  write_text(folder / "report.csv", csv(data));
  write_text(folder / "report.md", markdown(data));
}

}  // namespace loom::measure
