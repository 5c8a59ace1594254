// Model: scenes, plugins and files that change under it.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "viewer/model.h"

namespace loom::viewer {

std::string pipeline_file(const std::string& name) {
  std::error_code error;
  const std::filesystem::path shipped = std::filesystem::path(plugins::data_dir()) / "pipelines" / (name + ".json");
  return !std::filesystem::exists(name, error) && std::filesystem::exists(shipped, error) ? shipped.string() : name;
}

std::unique_ptr<Registry> Model::load_registry(Diagnostics& diagnostics) const {
  auto registry = std::make_unique<Registry>();
  plugins::load_plugins(search_, *registry, diagnostics);
  return registry;
}

bool Model::use_setup(std::unique_ptr<scene::Setup> setup, Edits edits) {
  const SceneFacts facts = scene::compute_facts(setup->scene);
  auto gpu_scene = scene::GpuScene::create(setup->scene);
  edits.lights = setup->scene.lights;
  std::swap(edits_, edits);
  LivePipeline next;
  if (!next.compile(request(), {*registry_, *device_, facts})) {
    std::swap(edits_, edits);
    return fail(next.error());
  }
  // Passes may keep what they made of a scene, and the GPU scene points into the other one: in this order they go.
  other_.close();
  live_ = std::move(next);
  gpu_scene_ = std::move(gpu_scene);
  setup_ = std::move(setup);
  facts_ = facts;
  box_ = scene::world_box(setup_->scene);
  lights_changed_ = false;
  time_s_ = 0;
  ++view_version_;
  frame_index_ = 0;
  undo_.clear();
  return succeed();
}

bool Model::open_scene(const std::string& path) {
  try {
    Diagnostics warnings;
    auto setup = std::make_unique<scene::Setup>(
        scene::load_setup(path, "", warnings, options_.surfaces, {options_.allow_outside}));
    Edits edits = edits_;
    if (!setup->pipeline.empty()) {
      edits.pipeline = pipeline_file(setup->pipeline);
      edits.set[edits.pipeline] = Settings(setup->set.begin(), setup->set.end());
    }
    if (!use_setup(std::move(setup), std::move(edits))) return false;
  } catch (const Error& error) {
    return fail(error);
  } catch (const std::exception& error) {
    return fail(Error(error.what()));
  }
  scene_path_ = path;
  view_.reset();
  watch();
  return true;
}

bool Model::reload_scene() {
  const auto view = view_;
  if (!open_scene(scene_path_)) return false;
  view_ = view;
  return true;
}

bool Model::reload_plugins() {
  Diagnostics diagnostics;
  std::unique_ptr<Registry> registry = load_registry(diagnostics);
  if (diagnostics.has_errors()) return fail(diagnostics);
  LivePipeline next;
  if (!next.compile(request(), {*registry, *device_, facts_})) return fail(next.error());
  next.adopt(live_);
  live_ = std::move(next);
  other_.close();
  registry_ = std::move(registry);  // the last object of the old code is gone
  frame_index_ = 0;
  return succeed();
}

void Model::watch() {
  std::set<std::string> files(live_.files().begin(), live_.files().end());
  // A file that does not compile is in no program any more, and is the one to watch.
  for (std::string& file : device_->sources()) shader_files_.insert(std::move(file));
  files.insert(shader_files_.begin(), shader_files_.end());
  if (!scene_path_.empty()) files.insert(scene_path_);
  // A refused plugin is not in the registry, and is the one to watch: so all files of the folders are.
  plugin_files_ = plugins::plugin_files(search_);
  files.insert(plugin_files_.begin(), plugin_files_.end());
  watch_.watch({files.begin(), files.end()});
}

bool Model::poll_files() {
  const std::vector<std::string> changed = watch_.changed();
  if (changed.empty()) return false;
  const auto among = [](const std::vector<std::string>& list, const std::string& file) {
    return std::find(list.begin(), list.end(), file) != list.end();
  };
  bool plugin = false, scene = false, pipeline = false, shader = false;
  for (const std::string& file : changed) {
    if (among(plugin_files_, file)) {
      plugin = true;
    } else if (file == scene_path_) {
      scene = true;
    } else if (among(live_.files(), file)) {
      pipeline = true;
    } else {
      device_->invalidate(file);
      shader = true;
    }
  }
  if (plugin) reload_plugins();
  if (scene) reload_scene();
  if (pipeline && !plugin && !scene) compile();
  if (shader && !plugin && !scene && !pipeline) {
    if (!live_.prepare_again()) {
      fail(live_.error());
    } else if (other_.running() && !other_.prepare_again()) {
      fail(other_.error());
    } else {
      succeed();
    }
  }
  return true;
}

}  // namespace loom::viewer
