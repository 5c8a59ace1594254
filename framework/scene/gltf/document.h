#pragma once
// A glTF 2.0 file in memory: the JSON, the buffers, the buffer views with EXT_meshopt_compression undone. Every offset
// and length is checked once, when the file is opened; nothing is allocated by a number in the file that the bytes of
// the file do not account for.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "loom/diagnostic.h"
#include "scene/gltf/value.h"

namespace loom::scene::gltf {

using Bytes = std::span<const std::byte>;

/// Largest file that is read: what a GLB header can express.
inline constexpr std::size_t max_file_bytes = std::size_t{1} << 32;
struct Sparse {
  std::size_t count = 0;
  int index_view = -1;
  std::size_t index_offset = 0;
  int index_type = 0;
  int value_view = -1;
  std::size_t value_offset = 0;
};

struct Accessor {
  int view = -1;
  std::size_t offset = 0;
  std::size_t count = 0;
  int component_type = 0;  ///< GL enum: 5120 byte … 5126 float
  int components = 0;      ///< 1…4, 9, 16
  bool normalized = false;
  std::optional<Sparse> sparse;
  std::string pointer;
};

class Document {
 public:
  /// Reads a .gltf or .glb file with all its buffers, also from outside its folder where `outside` is allowed. Throws
  /// BadInput.
  Document(const std::string& path, Diagnostics& diagnostics, bool outside);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  ~Document() = default;

  [[nodiscard]] Value root() const { return {json_, "", path_}; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The path of the file that `uri`, the "uri" of `value`, names. Throws BadInput where it must not be read.
  [[nodiscard]] std::string file_of(const std::string& uri, const Value& value) const;
  [[nodiscard]] const std::vector<Accessor>& accessors() const { return accessors_; }
  /// Of the file and its buffers.
  [[nodiscard]] std::size_t file_bytes() const { return total_bytes_; }
  [[nodiscard]] std::size_t view_count() const { return views_.size(); }

  /// The bytes of a buffer view, decompressed at first use. `user` is named where it has none.
  Bytes view(int index, const std::string& user);
  /// Bytes between elements, 0 = tightly packed.
  [[nodiscard]] std::size_t view_stride(int index) const { return views_[static_cast<std::size_t>(index)].stride; }

  /// Zeros need no bytes in the file, so their number must not decide how much memory is taken: throws BadInput where
  /// it would.
  void check_count(const Accessor& accessor) const;
  /// Counts vertices, indices and keys that are read. A small file that names one accessor a million times must not
  /// fill the memory: throws BadInput beyond what its bytes account for.
  void spend(std::size_t elements, const std::string& user);
  void warn(std::string code, std::string message, const std::string& pointer = {}, std::string hint = {});
  void note(std::string code, std::string message, const std::string& pointer = {});
  [[noreturn]] void fail(const std::string& pointer, std::string code, std::string message,
                         std::string hint = {}) const {
    gltf::fail(path_, pointer, std::move(code), std::move(message), std::move(hint));
  }

 private:
  struct Meshopt {
    int buffer = -1;
    std::size_t offset = 0, length = 0, count = 0, stride = 0;
    std::string mode, filter;
  };
  struct View {
    int buffer = -1;
    std::size_t offset = 0, length = 0, stride = 0;
    std::optional<Meshopt> meshopt;
    std::optional<std::vector<std::byte>> decoded;
    std::string pointer;
  };
  void split_glb();
  void parse_json(std::string_view text);
  void check_asset();
  void read_buffers();
  void read_views();
  void read_accessors();
  Accessor read_accessor(const Value& value);
  Sparse read_sparse(const Value& value, const Accessor& accessor);
  void check_range(const Accessor& accessor, std::size_t element);
  std::vector<std::byte> decode_meshopt(const View& view);
  [[nodiscard]] Bytes buffer(int index) const { return buffers_[static_cast<std::size_t>(index)]; }

  std::string path_, folder_;
  bool outside_;
  Diagnostics* diagnostics_;
  std::vector<std::byte> file_;
  std::string_view json_text_;
  std::optional<Bytes> bin_chunk_;
  Json json_;
  std::vector<std::vector<std::byte>> owned_;
  std::vector<Bytes> buffers_;  ///< empty: a fallback that only an uncompressed reader would need
  std::vector<View> views_;
  std::vector<Accessor> accessors_;
  std::size_t total_bytes_ = 0;
  std::size_t spent_ = 0;
};

/// Bytes of one component of a GL type, 0 where there is no such type.
[[nodiscard]] std::size_t component_bytes(int component_type);

}  // namespace loom::scene::gltf
