#pragma once
// The inspector without its window: what is open, what was changed, when a frame is due. Tests drive it headless.
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "gpu/device.h"
#include "loom/diagnostic.h"
#include "loom/registry.h"
#include "plugins/loader.h"
#include "scene/gpu_scene.h"
#include "scene/load.h"
#include "viewer/entry.h"
#include "viewer/file_watch.h"
#include "viewer/live_pipeline.h"
#include "viewer/profile.h"
#include "viewer/undo.h"
#include "viewer/volume_cells.h"

namespace loom::viewer {

/// Frames that a pipeline with state is given to settle after the last change; then the view rests.
inline constexpr int settle_frames = 64;

/// A texture or buffer that can be looked at.
struct Inspectable {
  std::string pass, port, member;
  std::string name;  ///< "pass.port.member", "pass.persistent.sum", "x.y.image@prev"
  std::string type;  ///< of the bundle; empty for state
  std::string unit;
  bool buffer = false;
  bool made = false;   ///< false: nobody reads it; looking at it makes it
  bool state = false;  ///< persistent or history: always there
  bool never_negative = false;
};

/// A shipped pipeline goes by its name; everything else is a path.
std::string pipeline_file(const std::string& name);

class Model {
 public:
  /// Needs a current context. Throws Error where not even a first picture can be had.
  explicit Model(Options options);
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  // What is open. All of these return false where it cannot be had: what was there stays, problem() says why.
  bool open_scene(const std::string& path);
  bool open_pipeline(const std::string& path);
  /// A second pipeline that renders the same view, to be compared with; empty: none.
  bool compare_with(const std::string& path);
  [[nodiscard]] const std::string& compared_path() const { return other_path_; }
  /// Null where nothing is compared.
  [[nodiscard]] const LivePipeline* compared() const { return other_.running() ? &other_ : nullptr; }
  /// A scene, a run file or a pipeline, by its content.
  bool open_any(const std::string& path);
  [[nodiscard]] const std::string& scene_path() const { return scene_path_; }
  [[nodiscard]] const std::string& pipeline_path() const { return edits_.pipeline; }
  /// Pipelines beside the open one and the shipped ones, sorted by name.
  const std::vector<std::string>& pipelines();
  [[nodiscard]] const scene::Setup& setup() const { return *setup_; }
  [[nodiscard]] const SceneFacts& facts() const { return facts_; }
  [[nodiscard]] const scene::Box& box() const { return box_; }
  [[nodiscard]] const Registry& registry() const { return *registry_; }
  [[nodiscard]] const LivePipeline& live() const { return live_; }
  [[nodiscard]] const std::string& device() const { return device_description_; }

  // Edits. A gesture names edits that undo as one.
  bool set_param(const std::string& pass, const std::string& param, const std::string& json,
                 const std::string& gesture = {});
  bool reset_param(const std::string& pass, const std::string& param);
  [[nodiscard]] bool is_changed(const std::string& pass, const std::string& param) const;
  /// What differs from the pipeline's file.
  [[nodiscard]] const Settings& settings() const;
  bool set_light(std::size_t index, const scene::Light& light, const std::string& gesture = {});
  [[nodiscard]] bool lights_changed() const { return lights_changed_; }
  void end_gesture() { undo_.end_gesture(); }
  [[nodiscard]] bool can_undo() const { return undo_.can_undo(); }
  [[nodiscard]] bool can_redo() const { return undo_.can_redo(); }
  void undo();
  void redo();

  // View and time.
  [[nodiscard]] scene::Camera camera() const;
  bool set_camera(const scene::Camera& camera);
  void reset_camera();
  [[nodiscard]] bool camera_moved() const { return view_.has_value(); }
  [[nodiscard]] glm::ivec2 size() const { return size_; }
  bool resize(glm::ivec2 size);
  [[nodiscard]] bool animated() const { return !setup_->scene.animations.empty(); }
  [[nodiscard]] double time() const { return time_s_; }
  bool set_time(double time_s);
  bool playing = false;
  bool continuous = false;  ///< render on though nothing changes

  // Frames.
  [[nodiscard]] bool frame_due() const;
  /// Renders one frame; `dt_s` moves what plays.
  void frame(double dt_s);
  /// One frame in which no pass keeps its outputs, for captures.
  void render_all();
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] const Profile& profile() const { return profile_; }
  /// Medians for people: made anew a few times a second, since sorting thousands of samples costs more than a window.
  const std::vector<graph::PassTimes>& pass_times();
  const graph::FrameTimes& frame_times();
  /// Forgets history and accumulated state.
  void reset();
  /// Render again, since something changed.
  void touch();

  /// Counts changes of what is seen, whatever draws it: camera, size, lights, time, scene.
  [[nodiscard]] std::uint64_t view_version() const { return view_version_; }
  /// The output `hdr`, rows from the top; empty where the pipeline names none.
  [[nodiscard]] std::vector<glm::vec4> radiance() const;

  // Looking at a texture or buffer.
  [[nodiscard]] std::vector<Inspectable> inspectables() const;
  bool inspect(const std::string& name);
  [[nodiscard]] const std::string& inspected() const { return inspected_; }
  /// Null where it is not there, or the other of the two.
  [[nodiscard]] const Texture* inspected_texture() const;
  [[nodiscard]] const Buffer* inspected_buffer() const;
  /// Changes where the texture or buffer may have: a pass that keeps its outputs does not count.
  [[nodiscard]] std::uint64_t inspected_version() const;
  /// True where the texture is a volume or a field of probes that knows its place in the scene.
  [[nodiscard]] bool inspects_volume() const;
  /// That volume, read back; nothing where it is none.
  [[nodiscard]] std::optional<VolumeSource> inspected_volume() const;

  // For what is drawn into the picture.
  [[nodiscard]] const scene::GpuScene& gpu_scene() const { return *gpu_scene_; }
  [[nodiscard]] gpu::CachingDevice& programs() const { return *device_; }

  // Hot reload: looks at the files; true where something was reloaded or went wrong.
  bool poll_files();

  /// The newest problem of pipeline, shader, plugin, scene or edit; empty where the last thing done went well.
  [[nodiscard]] const Diagnostics& problem() const { return problem_; }
  void dismiss_problem() { problem_ = {}; }

  // Results.
  /// .png: the picture; .exr: radiance. False with problem().
  bool save_picture(const std::string& path);
  /// Only what differs from the open pipeline, which it extends.
  bool save_pipeline(const std::string& path);
  /// Reproduces the picture. Where lights were moved, a run file is written beside the inspector's state.
  std::string command_line();

 private:
  [[nodiscard]] Surroundings surroundings() const { return {*registry_, *device_, facts_}; }
  [[nodiscard]] PipelineRequest request() const;
  /// Of a pipeline output, an endpoint or a state; graph::none where there is none.
  [[nodiscard]] int resource_of(const std::string& name) const;
  bool compile();
  bool compile_other();
  bool fail(const Diagnostics& diagnostics);
  bool fail(const Error& error) { return fail(error.diagnostics()); }
  bool succeed();
  void apply(const Edits& target);
  void lights_moved();
  void watch();
  bool reload_plugins();
  bool reload_scene();
  bool use_setup(std::unique_ptr<scene::Setup> setup, Edits edits);
  [[nodiscard]] std::unique_ptr<Registry> load_registry(Diagnostics& diagnostics) const;
  std::string write_run_file() const;

  // Destroyed backwards: GL objects and passes before the plugins and the scene that they come from.
  Options options_;
  plugins::SearchPath search_;
  std::unique_ptr<Registry> registry_;
  std::unique_ptr<gpu::CachingDevice> device_;
  std::string device_description_;
  std::string scene_path_;
  std::unique_ptr<scene::Setup> setup_;
  SceneFacts facts_;
  scene::Box box_;
  std::unique_ptr<scene::GpuScene> gpu_scene_;
  LivePipeline live_, other_;
  std::string other_path_;

  Edits edits_;
  bool lights_changed_ = false;
  UndoStack undo_;
  std::optional<scene::Camera> view_;
  glm::ivec2 size_{512, 512};
  double time_s_ = 0;
  std::uint64_t frames_ = 0, frame_index_ = 0;
  std::uint64_t view_version_ = 1;
  int pending_ = 0;
  std::string inspected_, inspected_states_;   ///< endpoints; the second: where its probes stand
  std::map<std::string, std::uint64_t> made_;  ///< by pass: frames_ when it last made its outputs
  FileWatch watch_;
  std::vector<std::string> plugin_files_;
  std::set<std::string> shader_files_;
  std::vector<std::string> pipelines_;  ///< as of listed_at_s_, with listed_for_ open
  std::string listed_for_;
  double listed_at_s_ = 0;
  Profile profile_;
  std::vector<graph::PassTimes> times_;
  graph::FrameTimes frame_times_;
  double times_at_s_ = 0;
  Diagnostics problem_;
};

}  // namespace loom::viewer
