#include "viewer/model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include <glm/geometric.hpp>

#include "gpu/context.h"
#include "loom/json.h"
#include "viewer/values.h"

namespace loom::viewer {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> json_files(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  return files;
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

constexpr double longest_s = 1e6;  ///< of an animation

/// Within what floats resolve and cameras reach.
bool sane(const glm::dvec3& v) {
  constexpr double most = 1e9;
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

Diagnostics refused(const std::string& message) {
  Diagnostics diagnostics;
  diagnostics.error("refused", message);
  return diagnostics;
}

/// The names of inputs that a person sees are paths; the same file may be reached by two.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return a == b || fs::equivalent(a, b, error);
}

}  // namespace

Model::Model(Options options) : options_(std::move(options)) {
  gpu::require_current_context();
  search_ = {.dirs = options_.plugin_dirs, .copies = true};
  Diagnostics refused;
  registry_ = load_registry(refused);
  device_ = gpu::CachingDevice::create({.shader_roots = plugins::shader_roots(search_), .cache_dir = {}});
  device_description_ = device_->description();
  Diagnostics warnings;
  auto setup = std::make_unique<scene::Setup>(
      scene::load_setup(options_.scene, options_.camera, warnings, options_.surfaces, {options_.allow_outside}));
  scene_path_ = options_.scene;
  size_ = options_.size.value_or(setup->size.value_or(size_));
  Edits edits;
  edits.pipeline = pipeline_file(!options_.pipeline.empty() ? options_.pipeline
                                 : !setup->pipeline.empty() ? setup->pipeline
                                                            : std::string("lpv"));
  Settings& set = edits.set[edits.pipeline];
  for (const auto& [path, value] : setup->set) set[path] = value;
  for (const graph::Override& o : options_.set) set[o.pass + "." + o.param] = o.value;
  if (!use_setup(std::move(setup), std::move(edits))) throw BadInput(problem_);
  if (refused.has_errors()) problem_ = refused;
}

Model::~Model() = default;

bool Model::fail(const Diagnostics& diagnostics) {
  problem_ = diagnostics;
  return false;
}

bool Model::succeed() {
  if (live_.broken() && !live_.prepare_again()) return fail(live_.error());
  problem_ = {};
  watch();
  touch();
  if (!other_path_.empty() && (!other_.running() || other_.request().size != size_)) return compile_other();
  return true;
}

bool Model::compile_other() {
  const auto set = edits_.set.find(other_path_);
  const Settings settings = set == edits_.set.end() ? Settings{} : set->second;
  if (other_.compile({.path = other_path_, .set = settings, .size = size_, .inspect = {}}, surroundings())) return true;
  other_.close();
  other_path_.clear();
  return fail(other_.error());
}

bool Model::compare_with(const std::string& path) {
  other_.close();
  other_path_ = path;
  touch();
  return path.empty() || compile_other();
}

bool Model::compile() {
  PipelineRequest wanted = request();
  bool ok = live_.compile(wanted, surroundings());
  if (!ok && !wanted.inspect.empty()) {
    // Another pipeline has no such texture: it is the picture that counts.
    wanted.inspect.clear();
    if (live_.compile(wanted, surroundings())) {
      inspected_.clear();
      inspected_states_.clear();
      ok = true;
    }
  }
  if (!ok) {
    fail(live_.error());
    watch();
    return false;
  }
  frame_index_ = 0;
  return succeed();
}

bool Model::open_pipeline(const std::string& path) {
  if (same_file(path, edits_.pipeline)) return true;
  const Edits before = edits_;
  edits_.pipeline = path;
  if (!compile()) {
    edits_ = before;
    watch();
    return false;
  }
  undo_.push(before, {});
  return true;
}

bool Model::open_any(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  if (extension == ".gltf" || extension == ".glb") return open_scene(path);
  Diagnostics diagnostics;
  const json::Node root = json::parse_file(path, diagnostics);
  if (diagnostics.has_errors()) return fail(diagnostics);
  const bool pipeline = root.find("passes") != nullptr || root.find("extends") != nullptr;
  return pipeline ? open_pipeline(path) : open_scene(path);
}

const std::vector<std::string>& Model::pipelines() {
  constexpr double every_s = 1;
  const double now = seconds_now();
  if (now - listed_at_s_ < every_s && listed_for_ == edits_.pipeline) return pipelines_;
  listed_at_s_ = now;
  listed_for_ = edits_.pipeline;
  const fs::path shipped = fs::path(plugins::data_dir()) / "pipelines",
                 beside = fs::path(edits_.pipeline).parent_path();
  pipelines_ = json_files(shipped);
  if (!same_file(shipped.string(), beside.string()))
    for (std::string& file : json_files(beside)) pipelines_.push_back(std::move(file));
  // The open one goes by the path that it was opened with.
  for (std::string& file : pipelines_)
    if (fs::path(file).filename() == fs::path(edits_.pipeline).filename() && same_file(file, edits_.pipeline))
      file = edits_.pipeline;
  std::sort(pipelines_.begin(), pipelines_.end(),
            [](const auto& a, const auto& b) { return fs::path(a).stem() < fs::path(b).stem(); });
  return pipelines_;
}

bool Model::set_param(const std::string& pass, const std::string& param, const std::string& json,
                      const std::string& gesture) {
  const Edits before = edits_;
  if (!live_.set_param(pass, param, json, surroundings())) return fail(live_.error());
  const std::string path = pass + "." + param;
  Settings& set = edits_.set[edits_.pipeline];
  set[path] = json;
  const ParamValue* in_file = live_.value_in_file(path);
  if (in_file != nullptr && json_text(*in_file) == json) set.erase(path);
  undo_.push(before, gesture);
  return succeed();
}

bool Model::reset_param(const std::string& pass, const std::string& param) {
  const ParamValue* value = live_.value_in_file(pass + "." + param);
  return value == nullptr || set_param(pass, param, json_text(*value));
}

const Settings& Model::settings() const {
  static const Settings none;
  const auto set = edits_.set.find(edits_.pipeline);
  return set == edits_.set.end() ? none : set->second;
}

bool Model::is_changed(const std::string& pass, const std::string& param) const {
  return settings().contains(pass + "." + param);
}

bool Model::set_light(std::size_t index, const scene::Light& light, const std::string& gesture) {
  if (index >= edits_.lights.size()) return false;
  const bool sound = sane(light.position) && sane(light.direction) && sane(light.intensity) &&
                     glm::length(light.direction) > 1e-6 &&
                     std::min({light.intensity.x, light.intensity.y, light.intensity.z}) >= 0;
  if (!sound) return fail(refused("a light needs a place within 1e9 m, a direction, and an intensity from 0 to 1e9"));
  undo_.push(edits_, gesture);
  edits_.lights[index] = light;
  lights_moved();
  return true;
}

void Model::lights_moved() {
  scene::Scene& scene = setup_->scene;
  scene.lights = edits_.lights;
  for (scene::Node& node : scene.nodes) node.light = -1;  // where a person puts it is where it stays
  lights_changed_ = true;
  ++view_version_;
  gpu_scene_->update();
  // A plan depends on what kinds of lights there are and on whether anything is coloured.
  const SceneFacts facts = scene::compute_facts(scene);
  const bool same = facts.light_faces() == facts_.light_faces() && facts.lights() == facts_.lights() &&
                    facts.max_chroma == facts_.max_chroma;
  if (!same) {
    facts_ = facts;
    other_.close();
    compile();
  }
  touch();
}

void Model::apply(const Edits& target) {
  const bool lights = !edits_.lights.empty() && lights_changed_;
  const Edits before = edits_;
  edits_ = target;
  if (!compile()) {
    edits_ = before;
    return;
  }
  if (lights) lights_moved();
}

void Model::undo() {
  if (can_undo()) apply(undo_.undo(edits_));
}

void Model::redo() {
  if (can_redo()) apply(undo_.redo(edits_));
}

bool Model::resize(glm::ivec2 size) {
  size = glm::clamp(size, glm::ivec2(1), glm::ivec2(16384));
  if (size == size_) return true;
  const glm::ivec2 before = size_;
  size_ = size;
  ++view_version_;
  if (compile()) return true;
  size_ = before;
  return false;
}

void Model::touch() {
  const auto has_state = [](const LivePipeline& p) { return p.running() && p.has_state(); };
  const bool state = has_state(live_) || has_state(other_);
  pending_ = state ? settle_frames : 1;
  // Noise follows the frame's number: without state the picture shall depend on what is set, not on the way there.
  if (!state) frame_index_ = 0;
}

bool Model::frame_due() const { return live_.running() && !live_.broken() && (pending_ > 0 || playing || continuous); }

const std::vector<graph::PassTimes>& Model::pass_times() {
  const double now = seconds_now();
  if (now - times_at_s_ > .25 || times_.size() != live_.graph().order.size()) {
    times_at_s_ = now;
    times_ = live_.renderer().pass_times();
    frame_times_ = live_.renderer().frame_times();
  }
  return times_;
}

const graph::FrameTimes& Model::frame_times() {
  pass_times();
  return frame_times_;
}

void Model::reset() {
  live_.reset();
  frame_index_ = 0;
  touch();
}

bool Model::set_time(double time_s) {
  if (!(std::abs(time_s) <= longest_s)) return fail(refused("a time lies between 0 and 1e6 seconds"));
  time_s_ = std::max(time_s, 0.);
  ++view_version_;
  touch();
  return true;
}

void Model::frame(double dt_s) {
  if (!live_.running() || live_.broken()) return;
  const double dt = playing ? dt_s : 0;
  time_s_ += dt;
  if (dt > 0) ++view_version_;
  if (scene::pose(setup_->scene, time_s_)) {
    gpu_scene_->update();
    box_ = scene::world_box(setup_->scene);
  }
  const FrameInfo info{.index = frame_index_, .time_s = time_s_, .dt_s = dt};
  if (!live_.render(*gpu_scene_, scene::make_camera(camera(), box_, size_), info)) {
    fail(live_.error());
    return;
  }
  if (other_.running() && !other_.broken() &&
      !other_.render(*gpu_scene_, scene::make_camera(camera(), box_, size_), info))
    fail(other_.error());
  const std::vector<std::string> kept = live_.renderer().kept_passes();
  for (const graph::CompiledPass& pass : live_.graph().passes)
    if (std::find(kept.begin(), kept.end(), pass.name) == kept.end()) made_[pass.name] = frames_ + 1;
  profile_.add({.index = frames_, .start_s = seconds_now(), .passes = live_.renderer().newest_costs()});
  ++frame_index_;
  ++frames_;
  if (pending_ > 0) --pending_;
}

void Model::render_all() {
  if (!live_.prepare_again()) {
    fail(live_.error());
    return;
  }
  frame(0);
}

scene::Camera Model::camera() const {
  if (view_) return *view_;
  return setup_->camera_index >= 0 ? setup_->scene.cameras[static_cast<std::size_t>(setup_->camera_index)]
                                   : setup_->camera;
}

bool Model::set_camera(const scene::Camera& camera) {
  const bool sound = sane(camera.eye) && sane(camera.target) && sane(camera.up) && camera.eye != camera.target &&
                     glm::length(camera.up) > 1e-6 && camera.yfov_rad > 1e-4 && camera.yfov_rad < 3.14;
  if (!sound) return fail(refused("a camera needs an eye and another target within 1e9 m, and a field below 180°"));
  view_ = camera;
  ++view_version_;
  touch();
  return true;
}

void Model::reset_camera() {
  view_.reset();
  ++view_version_;
  touch();
}

std::vector<glm::vec4> Model::radiance() const {
  for (const graph::GraphOutput& output : live_.graph().outputs)
    if (output.name == "hdr" && !output.absent) return live_.renderer().read("hdr").texels;
  return {};
}

}  // namespace loom::viewer
