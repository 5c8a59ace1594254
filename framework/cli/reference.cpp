// loom reference: the truth, path-traced. Progressive, resumable, mergeable.
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/json_out.h"
#include "core/image_io.h"
#include "loom/diagnostic.h"
#include "reference/film.h"
#include "reference/path_tracer.h"
#include "reference/photons.h"
#include "reference/run.h"
#include "scene/load.h"

namespace loom::cli {
namespace {

namespace fs = std::filesystem;
constexpr std::uint32_t default_samples = 256;
constexpr glm::ivec2 default_size{512, 512};

struct Arguments {
  std::string scene, camera, surfaces, size, output;
  scene::LoadOptions load;
  std::optional<std::uint32_t> samples;
  std::optional<double> noise;
  std::optional<int> bounces;
  std::uint64_t seed = 0;
  int threads = 0;
  std::string method = "paths";
  int photons = reference::PhotonOptions{}.photons;
  double radius = reference::PhotonOptions{}.radius;
  std::vector<std::string> merge;
};

/// Where the accumulation of an image lies. A path that names an accumulation stays.
std::string film_of(const std::string& path) { return path.ends_with(".film") ? path : path + ".film"; }

std::string format(const char* pattern, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long long>(std::llround(std::fmin(seconds, 3.6e8)));
  if (s < 60) return std::to_string(s) + " s";
  if (s < 3600) return std::to_string(s / 60) + " min " + std::to_string(s % 60) + " s";
  return std::to_string(s / 3600) + " h " + std::to_string(s / 60 % 60) + " min";
}

/// The progress line, where stderr is a terminal; and the error against time.
class Report {
 public:
  ~Report() { clear(); }
  Report() = default;
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  bool operator()(const reference::Progress& p) {
    if (p.noise && (convergence_.empty() || p.measured_at != convergence_.back().samples)) {
      convergence_.push_back({p.measured_at, p.seconds, *p.noise});
    }
    const auto now = Clock::now();
    if (terminal_ && now - last_ > std::chrono::milliseconds(100)) {
      last_ = now;
      show(p);
    }
    return true;
  }

  void clear() {
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
  }

  [[nodiscard]] Json convergence() const {
    Json list = Json::array();
    for (const auto& c : convergence_) list.push_back({{"spp", c.samples}, {"seconds", c.seconds}, {"noise", c.noise}});
    return list;
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Point {
    std::uint32_t samples;
    double seconds, noise;
  };

  void show(const reference::Progress& p) {
    constexpr int width = 24;
    const int full = static_cast<int>(p.fraction * width);
    std::string line = "[" + std::string(static_cast<std::size_t>(full), '=') +
                       std::string(static_cast<std::size_t>(width - full), ' ') + "] " + std::to_string(p.samples);
    if (p.expected > 0) line += "/" + std::to_string(p.expected);
    line += " spp";
    if (p.noise) line += "  noise " + format("%.2f %%", 100 * *p.noise);
    line += format("  %.1f Mrays/s", p.rays_per_s * 1e-6);
    if (p.remaining_s) line += "  " + duration_text(*p.remaining_s) + " left";
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    shown_ = true;
  }

  bool terminal_ = isatty(STDERR_FILENO) == 1;
  bool shown_ = false;
  Clock::time_point last_;
  std::vector<Point> convergence_;
};

void check(const Arguments& arguments) {
  if (fs::path(arguments.output).extension() != ".exr") {
    throw bad_usage("-o " + arguments.output + ": a reference is written as .exr", "for example -o ref.exr");
  }
  const fs::path folder = fs::path(arguments.output).parent_path();
  if (!folder.empty() && !fs::is_directory(folder)) {
    throw bad_usage("-o " + arguments.output + ": there is no folder " + folder.string(), "make it first");
  }
  if (arguments.samples && *arguments.samples == 0) throw bad_usage("--spp 0 renders nothing", "give 1 or more");
  if (arguments.noise && !(*arguments.noise > 0 && std::isfinite(*arguments.noise))) {
    throw bad_usage("--noise must be above 0", "for example --noise 0.02");
  }
  if (arguments.bounces && *arguments.bounces < 0) {
    throw bad_usage("--bounces must be 0 or more", "leave it out for no limit");
  }
  if (arguments.method != "paths" && arguments.method != "photons") {
    throw bad_usage("--method " + arguments.method + ": there is none of that name", "paths or photons");
  }
  if (arguments.photons < 1 || arguments.photons > 1 << 26) {
    throw bad_usage("--photons must be from 1 to 67108864", "more passes (--spp) do the same with less memory");
  }
  if (!(arguments.radius > 0 && arguments.radius <= 1)) {
    throw bad_usage("--radius must be above 0 and at most 1", "it is in diagonals of the scene, for example 0.005");
  }
  if (arguments.threads < 0) throw bad_usage("--threads must be 0 or more", "0 uses all");
}

/// Writes the image and says what it took.
void finish(const reference::Film& film, const Arguments& arguments, const Session& session, const Json& convergence) {
  write_exr(arguments.output, film.layers());
  const double paths = static_cast<double>(film.least_count()) * film.size().x * film.size().y;
  const double seconds = std::max(film.seconds, 1e-9);
  const double noise = film.relative_error();
  if (film.non_finite() > 0) {
    note(std::to_string(film.non_finite()) + " samples were not finite and count as zero");
  }
  if (session.json) {
    Json document = versioned();
    document["output"] = arguments.output;
    document["size"] = {film.size().x, film.size().y};
    document["spp"] = film.least_count();
    document["seeds"] = film.seeds();
    document["noise"] = noise;
    document["seconds"] = film.seconds;
    document["rays"] = film.rays;
    document["rays_per_s"] = static_cast<double>(film.rays) / seconds;
    document["paths_per_s"] = paths / seconds;
    document["non_finite"] = film.non_finite();
    document["convergence"] = convergence;
    print(document);
    return;
  }
  note(arguments.output + ": " + std::to_string(film.least_count()) + " spp in " + format("%.1f s", film.seconds) +
       ", noise " + format("%.2f %%", 100 * noise) + ", " +
       format("%.2f Mrays/s", static_cast<double>(film.rays) / seconds * 1e-6) + ", " +
       format("%.2f Mpaths/s", paths / seconds * 1e-6));
}

void merge(const Arguments& arguments, const Session& session) {
  reference::Film film = reference::Film::load(film_of(arguments.merge.front()));
  for (std::size_t i = 1; i < arguments.merge.size(); ++i) {
    film.merge(reference::Film::load(film_of(arguments.merge[i])));
  }
  film.save(film_of(arguments.output));
  finish(film, arguments, session, Json::array());
}

/// Photon mapping: passes of all pixels, saved every few seconds.
void map_photons(const Arguments& arguments, const Session& session, const scene::Setup& setup, glm::ivec2 size) {
  const reference::PhotonOptions options{.bounces = arguments.bounces.value_or(-1),
                                         .seed = arguments.seed,
                                         .threads = arguments.threads,
                                         .photons = arguments.photons,
                                         .radius = arguments.radius};
  const std::string film_path = film_of(arguments.output);
  reference::Film film = reference::open_film(
      film_path, size, reference::identify(setup.scene, setup.camera, size, options), options.seed);
  if (film.least_count() > 0) note("going on from " + std::to_string(film.least_count()) + " passes in " + film_path);
  const glm::dvec3 origin = setup.camera.eye;
  const reference::PhotonMapper mapper(setup.scene, origin, options);
  const interop::Camera camera = reference::view_of(setup.camera, setup.scene, size, origin);
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };
  constexpr double save_every_s = 5;
  Clock::time_point saved = Clock::now();
  while (arguments.noise ? film.least_count() < 2 * reference::replicates || film.relative_error() > *arguments.noise
                         : film.least_count() < arguments.samples.value_or(default_samples)) {
    const Clock::time_point begun = Clock::now();
    mapper.accumulate(film, camera);
    film.seconds += seconds_since(begun);
    if (seconds_since(saved) < save_every_s) continue;
    film.save(film_path);
    saved = Clock::now();
  }
  film.save(film_path);
  note("the radius of the last pass is " + format("%.4g m", mapper.radius(film.least_count() - 1)));
  finish(film, arguments, session, Json::array());
}

void render(const Arguments& arguments, const Session& session) {
  Diagnostics diagnostics;
  const scene::Setup setup = scene::load_setup(find_scene(arguments.scene), arguments.camera, diagnostics,
                                               parse_surfaces(arguments.surfaces), arguments.load);
  report(diagnostics);
  const glm::ivec2 size = arguments.size.empty() ? setup.size.value_or(default_size) : parse_size(arguments.size);
  if (arguments.method == "photons") return map_photons(arguments, session, setup, size);

  reference::Options options;
  options.bounces = arguments.bounces.value_or(-1);
  options.seed = arguments.seed;
  options.threads = arguments.threads;
  reference::Target target{.samples = arguments.samples, .noise = arguments.noise};
  if (!target.samples && !target.noise) target.samples = default_samples;

  const std::string film_path = film_of(arguments.output);
  reference::Film film = reference::open_film(
      film_path, size, reference::identify(setup.scene, setup.camera, size, options), options.seed);
  if (film.least_count() > 0) note("going on from " + std::to_string(film.least_count()) + " spp in " + film_path);

  // Positions become float relative to the eye: exact where it matters, however far from the origin that is.
  const glm::dvec3 origin = setup.camera.eye;
  const reference::PathTracer tracer(setup.scene, origin, options);
  Report progress;
  reference::run(tracer, film, reference::view_of(setup.camera, setup.scene, size, origin), target, {.path = film_path},
                 [&](const reference::Progress& p) { return progress(p); });
  progress.clear();
  finish(film, arguments, session, progress.convergence());
}

}  // namespace

void add_reference(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("reference", "Path-trace a scene: the truth that pictures are measured against");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("scene", arguments->scene, "A .gltf, .glb or run file; default: the built-in Cornell box");
  command->add_option("-o,--output", arguments->output, "The .exr to write; its accumulation lies beside it as .film")
      ->required();
  auto* samples =
      command->add_option("--spp", arguments->samples, "Samples a pixel, rounded up to a multiple of 16 (default 256)");
  command->add_option("--noise", arguments->noise, "Stop when the estimated relative error is under this, e.g. 0.02")
      ->excludes(samples);
  command->add_option("--bounces", arguments->bounces,
                      "Reflections before light arrives at the visible surface (default: no limit)");
  command->add_option("--seed", arguments->seed, "Runs with different seeds are independent and can be merged");
  command->add_option("--size", arguments->size, "WxH (default: the run file's, or 512x512)");
  command->add_option("--camera", arguments->camera, "A camera of the scene by name, or JSON as in a run file");
  add_surfaces_option(*command, arguments->surfaces);
  command->add_option("--threads", arguments->threads, "0 = all; the image does not depend on it");
  command->add_option(
      "--method", arguments->method,
      "paths (default), or photons: photon mapping, which shares no estimator with it; --spp is passes");
  command->add_option("--photons", arguments->photons, "Photons that each pass sends out (default 200000)");
  command->add_option("--radius", arguments->radius,
                      "Of the first pass, in diagonals of the scene (default 0.005); it shrinks from pass to pass");
  command->add_option("--merge", arguments->merge, "Add up finished runs (their .exr or .film) instead of rendering");
  add_json_option(*command, session);
  add_load_options(*command, arguments->load);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] {
    check(*arguments);
    if (arguments->merge.empty()) {
      render(*arguments, session);
    } else {
      merge(*arguments, session);
    }
  });
}

}  // namespace loom::cli
