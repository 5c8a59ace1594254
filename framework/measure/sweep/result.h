#pragma once
// What was measured of one point, and its file.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <nlohmann/json_fwd.hpp>

#include "loom/export.h"

namespace loom::measure {

struct Spread {
  double median = 0, p95 = 0;
};

/// The error of one output against the reference.
struct OutputError {
  double relmse = std::numeric_limits<double>::quiet_NaN();  ///< mean over the seeds
  double low = 0, high = 0;  ///< 95 % of bootstrap resamples of image blocks lie between
  double seed_sd = 0;        ///< standard deviation of relmse over the seeds
  double mean_ratio = 0;     ///< Σa/Σr
  std::optional<double> flip;
  std::uint64_t non_finite = 0;
};

struct Result {
  std::string key;
  std::string scene, camera, pipeline;  ///< as the sweep names them
  std::string pipeline_path;
  std::vector<std::pair<std::string, std::string>> set;  ///< "pass.param", value as JSON text
  glm::ivec2 size{0};
  int samples = 1, frames = 1, seeds = 1;
  bool keep_static = true;
  std::string truth;    ///< id of the reference
  std::string content;  ///< hash of scene, pipeline and program: another means that the figures are out of date
  std::string failure;  ///< what went wrong; empty where it was measured

  std::map<std::string, OutputError> errors;  ///< of hdr, indirect and, where the pipeline keeps it apart, bounce
  bool no_indirect = false;                   ///< the pipeline makes no indirect light at all
  // Milliseconds of a frame with all its samples.
  Spread wall_ms, cpu_ms, gpu_ms;
  double first_ms = 0;  ///< the first frame: programs are compiled, or taken from the cache, and everything is made
  double anew_ms = 0;   ///< a frame that makes everything anew, with its programs at hand; 0 with one seed
  std::size_t bytes = 0, bytes_without_aliasing = 0;
  std::optional<double> flicker;
  std::string device, version;
  // Seconds of the process: loading and preparing, frames, and all else (reading back, errors, pictures).
  double load_s = 0, frames_s = 0, rest_s = 0;

  [[nodiscard]] double error(const std::string& output) const {
    const auto found = errors.find(output);
    return found == errors.end() ? std::numeric_limits<double>::quiet_NaN() : found->second.relmse;
  }
};

LOOM_API nlohmann::ordered_json to_json(const Result& result);
/// Throws BadInput naming `file` where it is none.
LOOM_API Result result_from(const nlohmann::ordered_json& document, const std::string& file);

/// `<folder>/points/<key>.json`: one file a point, written beside and renamed.
LOOM_API std::string result_path(const std::string& folder, const std::string& key);
LOOM_API void write_result(const std::string& folder, const Result& result);
/// Nothing where there is no such file, or it is damaged.
LOOM_API std::optional<Result> read_result(const std::string& folder, const std::string& key);

}  // namespace loom::measure
