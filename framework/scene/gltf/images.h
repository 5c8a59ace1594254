#pragma once
// Images of a glTF file: which ones are needed, and decoding them on all cores while the geometry is read.
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <oneapi/tbb/task_group.h>

#include "scene/gltf/document.h"
#include "scene/scene.h"

namespace loom::scene::gltf {

/// Scene images are made of those that materials ask for. A mirrored repeat is an image of twice the size that holds
/// the mirrored tile too, so that everyone downstream knows repeat and clamp alone.
class Images {
 public:
  explicit Images(Document& document);
  Images(const Images&) = delete;
  Images& operator=(const Images&) = delete;
  ~Images();

  /// Index into Scene::images of glTF image `index`, mirrored along u or v.
  int use(int index, bool mirror_u, bool mirror_v);
  /// Starts decoding what was asked for so far; nothing may be asked for after it.
  void start();
  /// Waits, warns of what could not be read, and hands the images over. An image that could not be read is one white
  /// texel of no name: `ok()` tells.
  std::vector<Image> finish();
  [[nodiscard]] bool ok(int scene_image) const { return jobs_[static_cast<std::size_t>(scene_image)].failure.empty(); }

 private:
  struct Job {
    int image = 0;
    bool mirror_u = false, mirror_v = false;
    std::string pointer, name, path;  ///< path empty: embedded
    Bytes bytes;                      ///< embedded
    std::vector<std::byte> owned;
    Image result;
    std::string failure;
  };
  void locate(Job& job, const Value& value);
  void decode(Job& job);

  Document& document_;
  std::vector<Value> values_;
  std::map<std::tuple<int, bool, bool>, int> used_;
  std::vector<Job> jobs_;
  std::atomic<std::size_t> free_bytes_;
  oneapi::tbb::task_group tasks_;
};

}  // namespace loom::scene::gltf
