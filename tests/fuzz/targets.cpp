#include "fuzz/targets.h"

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "core/image_io.h"
#include "graph/compile/compile.h"
#include "graph/fakes.h"
#include "loom/diagnostic.h"
#include "loom/plugin.h"
#include "plugins/library.h"
#include "plugins/loader.h"
#include "scene/load.h"

namespace loom::fuzz {
namespace {

namespace fs = std::filesystem;

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// The bytes as a file in a folder of this process; the same one is written again and again.
std::string file_of(Bytes bytes, const std::string& name) {
  static const struct Folder {
    fs::path path = fs::temp_directory_path() / ("loom-fuzz-" + std::to_string(getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  } folder;
  std::string path = (folder.path / name).string();
  std::ofstream(path, std::ios::binary).write(text_of(bytes).data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

bool starts_with(Bytes bytes, std::string_view magic) { return text_of(bytes).substr(0, magic.size()) == magic; }

/// Errors are answers; anything else that is thrown goes on and ends the process.
template <class Work>
void answer(const Work& work) {
  try {
    work();
  } catch (const Error&) {
  }
}

}  // namespace

void pipeline(Bytes bytes) {
  static const Registry registry = test::fake_registry();
  (void)graph::compile_text(std::string(text_of(bytes)), file_of({}, "pipeline.json"), registry, test::one_light());
}

void run_file(Bytes bytes) {
  answer([&] {
    Diagnostics diagnostics;
    (void)scene::load_setup(file_of(bytes, "run.json"), "", diagnostics);
  });
}

void gltf(Bytes bytes) {
  answer([&] {
    Diagnostics diagnostics;
    const std::string path = file_of(bytes, starts_with(bytes, "glTF") ? "scene.glb" : "scene.gltf");
    (void)scene::compute_facts(scene::load_gltf(path, diagnostics));
  });
}

void image(Bytes bytes) {
  const bool png = starts_with(bytes, "\x89PNG");
  answer([&] { (void)(png ? read_png(file_of(bytes, "image.png")) : read_exr(file_of(bytes, "image.exr"))); });
}

void plugin(Bytes bytes) {
  std::string text(text_of(bytes));
  // A plugin is code: what dlopen() maps may do anything. A stamp of another ABI keeps it from getting that far; a file
  // that brings a stamp of its own is compared alone.
  const std::string_view marker = PluginStamp::marker;
  if (text.find(marker) != std::string::npos) {
    (void)plugins::stamped_version(file_of(bytes, "stamped.so"));
    return;
  }
  PluginStamp foreign{};
  std::memcpy(foreign.magic, marker.data(), marker.size());
  text.append(reinterpret_cast<const char*>(&foreign), sizeof(foreign));
  const fs::path file = file_of(std::as_bytes(std::span(text)), "plugins.d");
  const fs::path folder = file.string() + "-folder";
  fs::create_directories(folder);
  fs::rename(file, folder / "plugin.so");
  answer([&] {
    Registry registry;
    Diagnostics diagnostics;
    plugins::load_plugins({.dirs = {folder.string()}, .installed = false}, registry, diagnostics);
  });
}

}  // namespace loom::fuzz
