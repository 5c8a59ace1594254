// Model: pictures, pipelines and command lines out of what is open.
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "core/image_io.h"
#include "measure/picture.h"
#include "scene/sky.h"
#include "viewer/export.h"
#include "viewer/model.h"
#include "viewer/user_state.h"
#include "viewer/values.h"

namespace loom::viewer {

namespace {

namespace fs = std::filesystem;

BadInput bad_path(const std::string& message) {
  Diagnostics diagnostics;
  diagnostics.error("usage", message);
  return BadInput(diagnostics);
}

}  // namespace

bool Model::save_picture(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  try {
    if (extension != ".png" && extension != ".exr") throw bad_path(path + ": a picture is a .png or an .exr");
    const std::string output = extension == ".png" ? "image" : "hdr";
    measure::write_image(path, extension == ".png", live_.renderer().read(output), output);
    return true;
  } catch (const Error& error) {
    return fail(error);
  }
}

bool Model::save_pipeline(const std::string& path) {
  try {
    if (fs::path(path).extension() != ".json") throw bad_path(path + ": a pipeline is a .json file");
    std::error_code error;
    if (fs::equivalent(path, edits_.pipeline, error))
      throw bad_path(path + " is the pipeline that this one extends: save it under another name");
    const fs::path folder = fs::absolute(fs::path(path)).parent_path();
    const fs::path base = fs::relative(fs::absolute(edits_.pipeline), folder, error);
    const std::string text = pipeline_text(fs::path(path).stem().string(),
                                           error ? fs::absolute(edits_.pipeline).string() : base.string(), settings());
    write_file_atomic(path, std::as_bytes(std::span(text)));
    return true;
  } catch (const Error& error) {
    return fail(error);
  }
}

std::string Model::write_run_file() const {
  const std::string text = run_file_text(fs::absolute(setup_->scene.path).string(), edits_.lights,
                                         scene::sky_json(setup_->scene), camera(), setup_->scene.origin);
  const fs::path path =
      fs::path(made_state_dir()) / ("view-" + std::to_string(std::hash<std::string>{}(text)) + ".json");
  write_file_atomic(path.string(), std::as_bytes(std::span(text)));
  return path.string();
}

std::string Model::command_line() {
  RenderCommand command{.scene = scene_path_,
                        .pipeline = edits_.pipeline,
                        .camera = view_ ? camera_json(*view_, setup_->scene.origin) : options_.camera,
                        .set = settings(),
                        .size = size_,
                        .plugin_dirs = options_.plugin_dirs};
  if (time_s_ > 0) {
    command.frames = 2;  // the first at 0, the second at this time
    command.dt_s = time_s_;
  } else if (live_.has_state()) {
    command.frames = settle_frames;
  }
  try {
    if (lights_changed_) {
      command.scene = write_run_file();
      command.camera.clear();
    } else {
      // What the run file sets and a person took back has to be said.
      for (const auto& [path, value] : setup_->set)
        if (const ParamValue* in_file = live_.value_in_file(path)) command.set.emplace(path, json_text(*in_file));
    }
  } catch (const Error& error) {
    fail(error);
    return {};
  }
  return command_text(command);
}

}  // namespace loom::viewer
