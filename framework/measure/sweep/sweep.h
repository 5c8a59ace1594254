#pragma once
// A sweep file: which scenes, pipelines and parameter values are measured, and how.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/json.h"

namespace loom::measure {

/// When a reference is good enough: samples a pixel, or the root of its own relMSE.
struct TruthTarget {
  std::optional<std::uint32_t> spp;
  std::optional<double> noise;
};

/// The camera moves in equal steps along its own axes (right, up, forward), in shares of the scene's diagonal.
struct FlickerPath {
  int frames = 12;
  glm::dvec3 move{.003, .001, 0};
};

/// How each point is measured; the same for all points of a sweep.
struct Settings {
  glm::ivec2 size{128, 128};
  int samples = 4;          ///< a pixel: a frame is all of them, and so is its time
  int frames = 5;           ///< timed ones, after one that warms up
  int seeds = 2;            ///< independent pictures that the error is a mean of
  bool keep_static = true;  ///< passes whose input did not change keep their outputs, as loom render has it
  std::optional<FlickerPath> flicker;
  TruthTarget truth{.spp = 1024, .noise = std::nullopt};
};

struct SweepScene {
  std::string name;  ///< as the file has it
  std::string path;  ///< what load_setup() takes
  std::string camera;
  std::optional<glm::ivec2> size;
};

/// A parameter and the values it takes: listed, all that a choice has, or steps through (a part of) its declared range.
struct Knob {
  std::string pass, param;
  std::vector<json::Node> values;
  bool all = false;
  int steps = 0;  ///< above 0: a range
  std::optional<json::Node> from, to;
  SourceLocation where;
};

/// One pipeline with the grid of its knobs.
struct SweepEntry {
  std::string name, path;
  std::vector<Knob> knobs;
  SourceLocation where;
};

struct Sweep {
  std::string file, name, summary;
  Settings settings;
  std::vector<SweepScene> scenes;
  std::vector<SweepEntry> pipelines;
};

/// From names as people write them to files; both throw BadInput with the nearest name.
struct Names {
  std::function<std::string(const std::string&)> scene, pipeline;
};

/// Reads a sweep file. A name is that of a file beside it, or what `names` finds. Throws BadInput with every mistake at
/// its place.
LOOM_API Sweep read_sweep(const std::string& path, const Names& names);

}  // namespace loom::measure
