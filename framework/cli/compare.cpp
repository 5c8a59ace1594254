// loom compare: how far a picture is from the truth.
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/json_out.h"
#include "loom/diagnostic.h"
#include "measure/colormap.h"
#include "measure/layers.h"
#include "measure/metrics.h"

namespace loom::cli {
namespace {

struct Arguments {
  std::string a, reference, layer, mask, heatmap;
  std::vector<std::string> fail_above;
};

/// What --fail-above may name. A metric that has no value here (NaN) is above every limit.
struct MetricName {
  const char* name;
  double (*value)(const measure::Metrics&);
};
constexpr std::array metric_names = {
    MetricName{"relmse", [](const measure::Metrics& m) { return m.relmse; }},
    MetricName{"rmse", [](const measure::Metrics& m) { return m.rmse; }},
    MetricName{"smape", [](const measure::Metrics& m) { return m.smape; }},
    MetricName{"flip",
               [](const measure::Metrics& m) { return m.flip.value_or(std::numeric_limits<double>::quiet_NaN()); }},
    MetricName{"mean_ratio", [](const measure::Metrics& m) { return m.mean_ratio; }},
    MetricName{"p99_abs", [](const measure::Metrics& m) { return m.p99_abs; }},
    MetricName{"non_finite", [](const measure::Metrics& m) { return static_cast<double>(m.non_finite); }},
};

struct Limit {
  const MetricName* metric;
  double most;
};

Limit parse_limit(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  std::vector<std::string> names;
  const MetricName* metric = nullptr;
  for (const MetricName& candidate : metric_names) {
    names.emplace_back(candidate.name);
    if (name == candidate.name) metric = &candidate;
  }
  if (equals == std::string::npos || metric == nullptr) {
    const std::string near = nearest_name(name, names);
    throw bad_usage("--fail-above " + text + ": expected METRIC=NUMBER",
                    (near.empty() || near == name ? "" : "did you mean " + near + "? ") + "metrics: " + joined(names));
  }
  const std::string number = text.substr(equals + 1);
  double most = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), most);
  if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(most)) {
    throw bad_usage("--fail-above " + text + ": `" + number + "` is no finite number", "for example " + name + "=0.01");
  }
  return {.metric = metric, .most = most};
}

/// `42`, `4.8e-04`; "undefined" where there is no value.
std::string number_text(double value) {
  if (std::isnan(value)) return "undefined";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// Findings that make the answer "no": limits that are exceeded, nothing to compare.
Diagnostics verdict(const measure::Metrics& metrics, const std::vector<Limit>& limits) {
  Diagnostics findings;
  if (metrics.pixels == 0) {
    findings.error("no-valid-pixels", "no pixel can be compared: " + std::to_string(metrics.non_finite) +
                                          " are not finite, the rest is outside the mask");
  }
  for (const Limit& limit : limits) {
    const double value = limit.metric->value(metrics);
    if (value <= limit.most) continue;
    const std::string name = limit.metric->name;
    findings.error("above-limit",
                   std::isnan(value)
                       ? name + " has no value for these pictures, so it is not within " + number_text(limit.most)
                       : name + " is " + number_text(value) + ", above " + number_text(limit.most));
  }
  return findings;
}

Json number_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json report_json(const measure::LayerPair& layers, const measure::Comparison& comparison, const Diagnostics& findings) {
  const measure::Metrics& m = comparison.metrics;
  Json document = versioned();
  document["relmse"] = number_json(m.relmse);
  document["rmse"] = number_json(m.rmse);
  document["smape"] = number_json(m.smape);
  document["flip"] = m.flip ? number_json(*m.flip) : Json(nullptr);
  document["mean_ratio"] = number_json(m.mean_ratio);
  document["p99_abs"] = number_json(m.p99_abs);
  document["non_finite"] = m.non_finite;
  document["pixels"] = m.pixels;
  document["layers"] = {{"a", layers.a.name}, {"reference", layers.reference.name}};
  if (comparison.flip && comparison.flip->exposures) {
    const measure::Exposures& e = *comparison.flip->exposures;
    document["flip_exposures"] = {{"start", e.start}, {"stop", e.stop}, {"count", e.count}};
  }
  if (!findings.all().empty()) document["diagnostics"] = to_json(findings);
  return document;
}

void print_text(const Arguments& arguments, const measure::LayerPair& layers, const measure::Comparison& comparison) {
  const measure::Metrics& m = comparison.metrics;
  std::string flip = "no meaning for this layer";
  if (m.flip) {
    flip = number_text(*m.flip) + "  (LDR)";
    if (const auto& e = comparison.flip->exposures) {
      flip = number_text(*m.flip) + "  (HDR, " + std::to_string(e->count) + " exposures from " + number_text(e->start) +
             " to " + number_text(e->stop) + " stops)";
    }
  }
  std::printf("%s (%s) against %s (%s)\n", arguments.a.c_str(), layers.a.name.c_str(), arguments.reference.c_str(),
              layers.reference.name.c_str());
  std::printf("  relmse      %s\n", number_text(m.relmse).c_str());
  std::printf("  rmse        %s\n", number_text(m.rmse).c_str());
  std::printf("  smape       %s\n", number_text(m.smape).c_str());
  std::printf("  flip        %s\n", flip.c_str());
  std::printf("  mean ratio  %s\n", number_text(m.mean_ratio).c_str());
  std::printf("  p99 |a-r|   %s\n", number_text(m.p99_abs).c_str());
  std::printf("  non-finite  %llu pixels\n", static_cast<unsigned long long>(m.non_finite));
  std::printf("  compared    %llu pixels\n", static_cast<unsigned long long>(m.pixels));
}

void run(const Arguments& arguments, Session& session) {
  std::vector<Limit> limits;
  for (const std::string& text : arguments.fail_above) limits.push_back(parse_limit(text));
  if (!arguments.heatmap.empty() && !arguments.heatmap.ends_with(".png")) {
    throw bad_usage("--heatmap " + arguments.heatmap + ": a heat map is a .png", "for example --heatmap error.png");
  }
  const measure::ImageFile a = measure::read_image(arguments.a);
  const measure::ImageFile reference = measure::read_image(arguments.reference);
  const auto choice = arguments.layer.empty() ? std::nullopt : std::optional(arguments.layer);
  const measure::LayerPair layers = measure::match_layers(a, reference, choice);
  std::vector<std::uint8_t> mask;
  if (!arguments.mask.empty()) mask = measure::mask_of(measure::find_layer(reference, arguments.mask));
  const measure::Comparison comparison = measure::compare(layers.a, layers.reference, a.hdr && reference.hdr, mask);

  if (!arguments.heatmap.empty()) {
    if (!comparison.flip) {
      throw bad_input("no-heatmap", "FLIP has no meaning for " + layers.reference.name + ", so there is no heat map",
                      "leave --heatmap out, or choose a layer of three colours with --layer");
    }
    const measure::FlipMap& map = *comparison.flip;
    measure::write_heatmap(arguments.heatmap, map.width, map.height, map.error);
  }
  const measure::Metrics& metrics = comparison.metrics;
  if (metrics.non_finite > 0) {
    note(arguments.a + ": " + std::to_string(metrics.non_finite) +
         " pixels are NaN or infinite; they are counted, and are in none of the means");
  }
  const Diagnostics findings = verdict(metrics, limits);
  report(findings);
  if (session.json) {
    print(report_json(layers, comparison, findings));
  } else {
    print_text(arguments, layers, comparison);
  }
  if (findings.has_errors()) session.exit_code = 1;
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("compare", "Measure how far a picture is from a reference");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("a", arguments->a, "The picture: .exr or .png")->required();
  command->add_option("reference", arguments->reference, "The truth: .exr or .png")->required();
  command->add_option("--layer", arguments->layer,
                      "A:REF, layers by name (RGB, indirect, depth.Z, ...), or one for both; "
                      "default: what loom:quantity of A asks for");
  command->add_option("--mask", arguments->mask, "Compare only where this layer of the reference is above 0 (depth)");
  command->add_option("--heatmap", arguments->heatmap, "Write the FLIP error of every pixel as .png");
  command->add_option("--fail-above", arguments->fail_above, "METRIC=NUMBER: exit with 1 where it is above; repeatable")
      ->allow_extra_args(false);
  add_json_option(*command, session);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
