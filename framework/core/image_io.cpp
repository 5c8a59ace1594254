#include "core/image_io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fcntl.h>
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <system_error>
#include <utility>

#include "core/srgb.h"
#include "loom/diagnostic.h"

namespace loom {
namespace {

namespace fs = std::filesystem;

/// A header may claim any size; more pixels than this are refused before memory is taken for them.
constexpr std::int64_t max_pixels = std::int64_t{1} << 28;
constexpr std::size_t max_channels = 256;

[[noreturn]] void bad_image(const std::string& path, const std::string& what) {
  throw BadInput(Diagnostic{.code = "bad-image", .message = path + ": " + what, .where = {.file = path}});
}

/// A file beside `path` that becomes it by commit(), or is removed.
class PendingFile {
 public:
  explicit PendingFile(const std::string& path)
      : path_(path), name_(path + ".part" + std::to_string(static_cast<long>(getpid()))) {}
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile() {
    std::error_code ignored;
    if (!committed_) fs::remove(name_, ignored);
  }
  [[nodiscard]] const std::string& name() const { return name_; }
  void commit() {
    std::error_code error;
    fs::rename(name_, path_, error);
    if (error) throw Error("cannot write " + path_ + ": " + error.message());
    committed_ = true;
  }

 private:
  std::string path_, name_;
  bool committed_ = false;
};

std::string why_not_writable(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  std::error_code ignored;
  if (!folder.empty() && !fs::is_directory(folder, ignored)) return "the folder " + folder.string() + " does not exist";
  return std::generic_category().message(errno);
}

void append(void* context, void* data, int size) {
  auto& bytes = *static_cast<std::vector<std::byte>*>(context);
  const auto* begin = static_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), begin, begin + size);
}

std::uint8_t to_byte(float value) {
  // NaN becomes 0: an 8-bit picture has nothing else for it.
  return static_cast<std::uint8_t>(std::lround(255.f * (value > 0.f ? std::min(value, 1.f) : 0.f)));
}

std::vector<std::byte> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code ignored;
  if (!file || fs::is_directory(path, ignored)) bad_image(path, "cannot be read: no such file, or no permission");
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  if (text.empty()) bad_image(path, "is empty");
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// What a file claims to hold can be no more than so many times its own size: deflate makes a byte of 1032 at most.
/// Memory is not taken on a number's word.
void require_plausible(const std::string& path, std::int64_t width, std::int64_t height, std::size_t bytes_a_pixel,
                       std::uintmax_t largest_ratio) {
  std::error_code ignored;
  const auto claimed = static_cast<std::uintmax_t>(width * height) * bytes_a_pixel;
  if (claimed / largest_ratio > fs::file_size(path, ignored)) {
    bad_image(path, "claims " + std::to_string(width) + "x" + std::to_string(height) + " pixels, more than a file of " +
                        "its size can hold");
  }
}

/// Interleaved triples as layers, each number by `linear`.
template <class T, class Linear>
ImageLayers split_rgb(const T* rgb, int width, int height, Linear linear) {
  ImageLayers image{.width = width, .height = height, .channels = {}, .attributes = {}};
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const char* const names[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float>& values = image.channels[names[c]];
    values.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i) values[i] = linear(rgb[3 * i + c]);
  }
  return image;
}

}  // namespace

void write_file_atomic(const std::string& path, std::span<const std::byte> bytes) {
  PendingFile pending(path);
  std::ofstream file(pending.name(), std::ios::binary | std::ios::trunc);
  if (!file) throw Error("cannot write " + path + ": " + why_not_writable(path));
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw Error("cannot write " + path + ": " + why_not_writable(path));
  pending.commit();
}

void write_png(const std::string& path, int width, int height, std::span<const glm::vec3> display) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (width < 1 || height < 1 || display.size() != pixels) {
    throw Error("cannot write " + path + ": " + std::to_string(display.size()) + " pixels for an image of " +
                std::to_string(width) + "x" + std::to_string(height));
  }
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * pixels);
  for (const glm::vec3& pixel : display) {
    for (int c = 0; c < 3; ++c) rgb.push_back(to_byte(pixel[c]));
  }
  std::vector<std::byte> png;
  if (stbi_write_png_to_func(&append, &png, width, height, 3, rgb.data(), 3 * width) == 0) {
    throw Error("cannot write " + path + ": encoding the PNG failed");
  }
  write_file_atomic(path, png);
}

void write_exr(const std::string& path, const ImageLayers& image) {
  const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width < 1 || image.height < 1 || image.channels.empty()) {
    throw Error("cannot write " + path + ": the image has no pixels or no channels");
  }
  PendingFile pending(path);
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, text] : image.attributes) header.insert(name, Imf::StringAttribute(text));
    Imf::FrameBuffer frame;
    for (const auto& [name, values] : image.channels) {
      if (values.size() != pixels) {
        throw Error("cannot write " + path + ": channel " + name + " has " + std::to_string(values.size()) +
                    " values for " + std::to_string(pixels) + " pixels");
      }
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      // OpenEXR's interface takes a pointer to mutable memory for writing too; it only reads it.
      auto* base = reinterpret_cast<char*>(const_cast<float*>(values.data()));
      frame.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * image.width));
    }
    Imf::OutputFile file(pending.name().c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& exception) {
    throw Error("cannot write " + path + ": " + (errno == ENOENT ? why_not_writable(path) : exception.what()));
  }
  pending.commit();
}

ImageLayers read_exr(const std::string& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) bad_image(path, "no such file");
  ImageLayers image;
  try {
    Imf::InputFile file(path.c_str());
    const Imf::Header& header = file.header();
    const Imath::Box2i window = header.dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > max_pixels / height) {
      bad_image(path, "claims " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
    }
    std::size_t count = 0;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) ++count;
    if (count == 0 || count > max_channels) bad_image(path, "has " + std::to_string(count) + " channels");
    require_plausible(path, width, height, 2 * count, 1032 * 64);  // deflated means of 8×8 pixels (DWA), in half floats

    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    Imf::FrameBuffer frame;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
      const Imf::Channel& description = channel.channel();
      if (description.xSampling != 1 || description.ySampling != 1) {
        bad_image(path, std::string("channel ") + channel.name() + " is subsampled, which is not supported");
      }
      std::vector<float>& values = image.channels[channel.name()];
      values.resize(static_cast<std::size_t>(width * height));
      frame.insert(channel.name(), Imf::Slice::Make(Imf::FLOAT, values.data(), window));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute())) {
        image.attributes[attribute.name()] = text->value();
      }
    }
  } catch (const Error&) {
    throw;
  } catch (const std::exception& exception) {
    bad_image(path, std::string("not an EXR that can be read: ") + exception.what());
  }
  return image;
}

ImageLayers read_hdr(const std::string& path) {
  const std::vector<std::byte> bytes = read_bytes(path);
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) bad_image(path, "is too large");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0;
  int height = 0;
  int components = 0;
  if (stbi_is_hdr_from_memory(data, size) == 0 ||
      stbi_info_from_memory(data, size, &width, &height, &components) == 0 || width < 1 || height < 1 ||
      width > max_pixels / height) {
    bad_image(path, "not a Radiance picture that can be read");
  }
  require_plausible(path, width, height, 4, 64);  // a run of 127 bytes takes two
  const std::unique_ptr<float, decltype(&stbi_image_free)> rgb(
      stbi_loadf_from_memory(data, size, &width, &height, &components, 3), &stbi_image_free);
  if (!rgb) bad_image(path, std::string("not a Radiance picture that can be read: ") + stbi_failure_reason());

  return split_rgb(rgb.get(), width, height, [](float value) { return value; });
}

ImageLayers read_png(const std::string& path) {
  const std::vector<std::byte> bytes = read_bytes(path);
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) bad_image(path, "is too large");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  static constexpr unsigned char signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (bytes.size() < sizeof(signature) || std::memcmp(data, signature, sizeof(signature)) != 0) {
    bad_image(path, "is not a PNG");
  }
  int width = 0;
  int height = 0;
  int components = 0;
  if (stbi_info_from_memory(data, size, &width, &height, &components) == 0 || width < 1 || height < 1 ||
      width > max_pixels / height) {
    bad_image(path, "not a PNG that can be read");
  }
  require_plausible(path, width, height, 1, 8 * 1032);  // deflated, a bit a pixel
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> rgb(
      stbi_load_from_memory(data, size, &width, &height, &components, 3), &stbi_image_free);
  if (!rgb) bad_image(path, std::string("not a PNG that can be read: ") + stbi_failure_reason());

  return split_rgb(rgb.get(), width, height,
                   [](stbi_uc value) { return srgb_to_linear(static_cast<float>(value) / 255.f); });
}

}  // namespace loom
