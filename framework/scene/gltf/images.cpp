#include "scene/gltf/images.h"

#include <stb/stb_image.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "scene/gltf/uri.h"

namespace loom::scene::gltf {
namespace {

constexpr std::size_t max_image_file_bytes = std::size_t{1} << 29;
constexpr int max_side = 1 << 15;
/// A picture's header may claim any size. Up to this much over the whole file is decoded in any case; beyond it a
/// picture must have a byte for every 1032 it decodes to, which is the most that deflate can reach.
constexpr std::size_t free_bytes = std::size_t{1} << 28;
constexpr std::size_t best_ratio = 1032;

/// The tile and its mirror image beside it.
Image mirrored(const Image& tile, bool u, bool v) {
  Image result;
  result.name = tile.name;
  result.width = tile.width * (u ? 2 : 1);
  result.height = tile.height * (v ? 2 : 1);
  result.rgba.resize(static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height) * 4);
  for (int y = 0; y < result.height; ++y) {
    const int from_y = y < tile.height ? y : 2 * tile.height - 1 - y;
    for (int x = 0; x < result.width; ++x) {
      const int from_x = x < tile.width ? x : 2 * tile.width - 1 - x;
      std::memcpy(&result.rgba[(static_cast<std::size_t>(y) * static_cast<std::size_t>(result.width) +
                                static_cast<std::size_t>(x)) *
                               4],
                  &tile.rgba[(static_cast<std::size_t>(from_y) * static_cast<std::size_t>(tile.width) +
                              static_cast<std::size_t>(from_x)) *
                             4],
                  4);
    }
  }
  return result;
}

struct FreeStbi {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

}  // namespace

Images::Images(Document& document)
    : document_(document), values_(document.root().items("images")), free_bytes_(free_bytes) {}

Images::~Images() {
  tasks_.cancel();
  tasks_.wait();
}

int Images::use(int index, bool mirror_u, bool mirror_v) {
  const auto [found, added] = used_.try_emplace({index, mirror_u, mirror_v}, static_cast<int>(jobs_.size()));
  if (!added) return found->second;
  Job job;
  job.image = index;
  job.mirror_u = mirror_u;
  job.mirror_v = mirror_v;
  locate(job, values_[static_cast<std::size_t>(index)]);
  jobs_.push_back(std::move(job));
  return found->second;
}

void Images::locate(Job& job, const Value& value) {
  job.pointer = value.pointer();
  job.name = value.text("name");
  const std::string uri = value.text("uri");
  const int view = value.index("bufferView", document_.view_count(), "bufferViews");
  if (uri.empty() == (view < 0)) value.fail("gltf-image", "must have either a \"uri\" or a \"bufferView\"");
  if (view >= 0) {
    job.bytes = document_.view(view, job.pointer);
  } else if (is_data_uri(uri)) {
    if (std::optional<std::vector<std::byte>> decoded = decode_data_uri(uri)) {
      job.owned = std::move(*decoded);
    } else {
      job.failure = "its data: URI is not valid base64";
    }
  } else {
    job.path = document_.file_of(uri, value);
    if (job.name.empty()) job.name = uri;
  }
}

void Images::start() {
  // jobs_ does not grow any more, so the references hold.
  for (Job& job : jobs_) {
    if (job.failure.empty()) tasks_.run([this, &job] { decode(job); });
  }
}

void Images::decode(Job& job) {
  if (!job.path.empty()) {
    std::string why;
    std::optional<std::vector<std::byte>> read = read_file(job.path, max_image_file_bytes, why);
    if (!read) {
      job.failure = job.path + " " + why;
      return;
    }
    job.owned = std::move(*read);
  }
  const Bytes bytes = job.bytes.empty() ? Bytes(job.owned) : job.bytes;
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(std::min(bytes.size(), max_image_file_bytes));
  int width = 0;
  int height = 0;
  int channels = 0;
  if (size == 0 || stbi_info_from_memory(data, size, &width, &height, &channels) == 0) {
    job.failure = size == 0 ? "is empty" : std::string("is no PNG or JPEG that can be read: ") + stbi_failure_reason();
    return;
  }
  if (width < 1 || height < 1 || width > max_side || height > max_side) {
    job.failure =
        "is " + std::to_string(width) + " × " + std::to_string(height) + " pixels, over " + std::to_string(max_side);
    return;
  }
  const std::size_t tiles = (job.mirror_u ? 2u : 1u) * (job.mirror_v ? 2u : 1u);
  const std::size_t pixel_bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  if (pixel_bytes / best_ratio > bytes.size()) {
    std::size_t left = free_bytes_.load();
    while (left >= pixel_bytes * tiles && !free_bytes_.compare_exchange_weak(left, left - pixel_bytes * tiles)) {
    }
    if (left < pixel_bytes * tiles) {
      job.failure =
          "claims " + std::to_string(width) + " × " + std::to_string(height) + " pixels, more than its bytes can hold";
      return;
    }
  }
  const std::unique_ptr<stbi_uc, FreeStbi> pixels(stbi_load_from_memory(data, size, &width, &height, &channels, 4));
  if (!pixels) {
    job.failure = std::string("cannot be decoded: ") + stbi_failure_reason();
    return;
  }
  job.result.width = width;
  job.result.height = height;
  job.result.rgba.assign(pixels.get(),
                         pixels.get() + static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  if (job.mirror_u || job.mirror_v) job.result = mirrored(job.result, job.mirror_u, job.mirror_v);
  job.owned = {};
}

std::vector<Image> Images::finish() {
  tasks_.wait();
  std::vector<Image> images;
  images.reserve(jobs_.size());
  for (Job& job : jobs_) {
    if (!job.failure.empty()) {
      document_.warn("gltf-image", "the image is left out, its material keeps the factor alone: " + job.failure,
                     job.pointer);
      job.result = {{}, 1, 1, {255, 255, 255, 255}};
    }
    job.result.name = job.name;
    images.push_back(std::move(job.result));
  }
  return images;
}

}  // namespace loom::scene::gltf
