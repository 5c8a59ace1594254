#include "scene/gltf/document.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

#include "scene/gltf/uri.h"

namespace loom::scene::gltf {
namespace {

std::uint32_t u32_at(Bytes bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);  // GLB is little-endian, and so is every target
  return value;
}

void line_and_column(std::string_view text, std::size_t byte, int& line, int& column) {
  byte = std::min(byte, text.size());
  const std::string_view before = text.substr(0, byte);
  line = 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t start = before.rfind('\n');
  column = static_cast<int>(byte - (start == std::string_view::npos ? 0 : start + 1));
}

constexpr std::uint32_t glb_magic = 0x46546c67;   // "glTF"
constexpr std::uint32_t json_chunk = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t bin_chunk = 0x004e4942;   // "BIN"

}  // namespace

std::size_t component_bytes(int component_type) {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

Document::Document(const std::string& path, Diagnostics& diagnostics, bool outside)
    : path_(path),
      folder_(std::filesystem::path(path).parent_path().string()),
      outside_(outside),
      diagnostics_(&diagnostics) {
  std::string why;
  std::optional<std::vector<std::byte>> bytes = read_file(path, max_file_bytes, why);
  if (!bytes) gltf::fail(path, "", "gltf-file", why, "give the path of a .gltf or .glb file");
  if (bytes->empty()) gltf::fail(path, "", "gltf-file", "is empty");
  file_ = std::move(*bytes);
  if (file_.size() >= 4 && u32_at(file_, 0) == glb_magic) {
    split_glb();
  } else {
    json_text_ = {reinterpret_cast<const char*>(file_.data()), file_.size()};
  }
  parse_json(json_text_);
  check_asset();
  read_buffers();
  total_bytes_ = file_.size();
  for (const std::vector<std::byte>& buffer_bytes : owned_) total_bytes_ += buffer_bytes.size();
  read_views();
  read_accessors();
}

void Document::split_glb() {
  const Bytes bytes = file_;
  if (bytes.size() < 20) fail("", "gltf-glb", "is shorter than a GLB header and its first chunk");
  if (const std::uint32_t version = u32_at(bytes, 4); version != 2) {
    fail("", "gltf-glb", "is GLB version " + std::to_string(version) + ", but only version 2 is read");
  }
  const std::size_t length = u32_at(bytes, 8);
  if (length > bytes.size()) {
    fail("", "gltf-glb", "says it has " + std::to_string(length) + " bytes, but has " + std::to_string(bytes.size()),
         "the file was cut short: fetch it again");
  }
  if (length < bytes.size()) warn("gltf-glb", "bytes after the end of the GLB are left out");
  std::size_t at = 12;
  for (int chunk = 0; at < length; ++chunk) {
    if (length - at < 8) fail("", "gltf-glb", "ends within the header of chunk " + std::to_string(chunk));
    const std::size_t size = u32_at(bytes, at);
    const std::uint32_t type = u32_at(bytes, at + 4);
    at += 8;
    if (size > length - at) {
      fail("", "gltf-glb",
           "chunk " + std::to_string(chunk) + " of " + std::to_string(size) + " bytes goes past the end of the file");
    }
    if (size % 4 != 0) fail("", "gltf-glb", "the length of chunk " + std::to_string(chunk) + " is no multiple of 4");
    const Bytes content = bytes.subspan(at, size);
    if (chunk == 0) {
      if (type != json_chunk) fail("", "gltf-glb", "the first chunk must be JSON");
      json_text_ = {reinterpret_cast<const char*>(content.data()), content.size()};
    } else if (type == json_chunk || (type == bin_chunk && chunk > 1)) {
      fail("", "gltf-glb", "chunk " + std::to_string(chunk) + " is a second JSON chunk or a misplaced BIN chunk");
    } else if (type == bin_chunk) {
      bin_chunk_ = content;
    } else {
      warn("gltf-glb", "a chunk of unknown type is left out");
    }
    at += size;
  }
}

void Document::parse_json(std::string_view text) {
  try {
    json_ = Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& error) {
    Diagnostic diagnostic{Severity::error, "gltf-json", "is no valid JSON", {path_, 0, 0, ""}, ""};
    line_and_column(text, error.byte, diagnostic.where.line, diagnostic.where.column);
    std::string_view detail = error.what();
    // "[json.exception.parse_error.101] parse error at line 1, column 2: <what is wrong>"
    if (const std::size_t colon = detail.find(": "); colon != std::string_view::npos) detail.remove_prefix(colon + 2);
    diagnostic.message += ": " + std::string(detail);
    throw BadInput(std::move(diagnostic));
  } catch (const Json::exception& error) {
    fail("", "gltf-json", std::string("is no valid JSON: ") + error.what());
  }
  if (!json_.is_object()) fail("", "gltf-json", "the root must be an object");
}

void Document::check_asset() {
  const Value asset = root().require("asset");
  const std::string version = asset.text("version");
  const std::string needed = asset.text("minVersion", "2.0");
  if (!version.starts_with("2.")) {
    asset.fail("gltf-version", "the version is \"" + version + "\", but only glTF 2 is read",
               "convert the file to glTF 2.0");
  }
  if (needed != "2.0") asset.fail("gltf-version", "needs glTF " + needed + ", but only 2.0 is read");
  if (version != "2.0") warn("gltf-version", "glTF " + version + " is read as 2.0", asset.pointer());
}

std::string Document::file_of(const std::string& uri, const Value& value) const {
  if (std::optional<std::string> path = resolve_uri(uri, folder_, outside_)) return std::move(*path);
  if (outside_) {
    value.fail("gltf-uri", "the URI \"" + uri + "\" is no path of a file", "name the file by a path, without a scheme");
  }
  value.fail(
      "gltf-uri", "the URI \"" + uri + "\" does not stay within the folder of the file",
      "put the file beside the .gltf file and name it by a relative URI, or allow it by --allow-outside where you "
      "trust the scene");
}

void Document::read_buffers() {
  const std::vector<Value> buffers = root().items("buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const Value& value = buffers[i];
    const auto length = static_cast<std::size_t>(
        value.integer("byteLength", std::nullopt, 1, static_cast<std::int64_t>(max_file_bytes)));
    const std::string uri = value.text("uri");
    Bytes bytes;
    const std::optional<Value> fallback = value.extension("EXT_meshopt_compression");
    if (!uri.empty() && is_data_uri(uri)) {
      std::optional<std::vector<std::byte>> decoded = decode_data_uri(uri);
      if (!decoded) value.fail("gltf-uri", "its data: URI is not valid base64");
      bytes = owned_.emplace_back(std::move(*decoded));
    } else if (!uri.empty()) {
      const std::string path = file_of(uri, value);
      std::string why;
      std::optional<std::vector<std::byte>> read = gltf::read_file(path, max_file_bytes, why);
      if (!read) value.fail("gltf-missing-file", "the buffer " + path + " " + why);
      bytes = owned_.emplace_back(std::move(*read));
    } else if (fallback && fallback->flag("fallback", false)) {
      buffers_.emplace_back();
      continue;
    } else if (i == 0 && bin_chunk_) {
      bytes = *bin_chunk_;
    } else {
      // Legal where nothing reads it; view() complains otherwise.
      warn("gltf-buffer", "the buffer has no data", value.pointer());
      buffers_.emplace_back();
      continue;
    }
    if (bytes.size() < length) {
      value.fail("gltf-buffer",
                 "must have " + std::to_string(length) + " bytes, but has " + std::to_string(bytes.size()));
    }
    buffers_.push_back(bytes.first(length));
  }
}

void Document::read_views() {
  const auto limit = static_cast<std::int64_t>(max_file_bytes);
  const auto size = [](std::int64_t value) { return static_cast<std::size_t>(value); };
  for (const Value& value : root().items("bufferViews")) {
    View view;
    view.pointer = value.pointer();
    view.buffer = value.required_index("buffer", buffers_.size(), "buffers");
    view.offset = size(value.integer("byteOffset", 0, 0, limit));
    view.length = size(value.integer("byteLength", std::nullopt, 1, limit));
    view.stride = size(value.integer("byteStride", 0, 0, 252));
    if (value.has("byteStride") && (view.stride < 4 || view.stride % 4 != 0)) {
      value.fail("gltf-range", "byteStride must be a multiple of 4 within 4 and 252");
    }
    if (const std::optional<Value> packed = value.extension("EXT_meshopt_compression")) {
      Meshopt meshopt;
      meshopt.buffer = packed->required_index("buffer", buffers_.size(), "buffers");
      meshopt.offset = size(packed->integer("byteOffset", 0, 0, limit));
      meshopt.length = size(packed->integer("byteLength", std::nullopt, 1, limit));
      meshopt.stride = size(packed->integer("byteStride", std::nullopt, 1, 256));
      meshopt.count = size(packed->integer("count", std::nullopt, 1, limit));
      meshopt.mode = packed->text("mode");
      meshopt.filter = packed->text("filter", "NONE");
      const Bytes source = buffer(meshopt.buffer);
      if (meshopt.offset > source.size() || meshopt.length > source.size() - meshopt.offset) {
        packed->fail("gltf-range", "goes past the end of its buffer of " + std::to_string(source.size()) + " bytes");
      }
      if (meshopt.count * meshopt.stride != view.length) {
        packed->fail("gltf-compression", "count · byteStride must be the byteLength of the view");
      }
      view.meshopt = std::move(meshopt);
    } else if (const Bytes source = buffer(view.buffer); !source.empty()) {
      if (view.offset > source.size() || view.length > source.size() - view.offset) {
        value.fail("gltf-range", "bytes " + std::to_string(view.offset) + " to " +
                                     std::to_string(view.offset + view.length) + " go past the end of the buffer of " +
                                     std::to_string(source.size()) + " bytes");
      }
    }
    views_.push_back(std::move(view));
  }
}

Bytes Document::view(int index, const std::string& user) {
  View& view = views_[static_cast<std::size_t>(index)];
  if (view.meshopt) {
    if (!view.decoded) view.decoded = decode_meshopt(view);
    return *view.decoded;
  }
  const Bytes source = buffer(view.buffer);
  if (source.empty()) fail(view.pointer, "gltf-buffer", "is read by " + user + ", but its buffer has no data");
  return source.subspan(view.offset, view.length);
}

void Document::spend(std::size_t elements, const std::string& user) {
  // A compressed mesh may have some ten vertices and indices a byte, and meshes may share vertices.
  constexpr std::size_t always_fine = std::size_t{1} << 22;
  constexpr std::size_t elements_per_byte = 16;
  const std::size_t limit = always_fine + elements_per_byte * total_bytes_;
  if (elements > limit - spent_) {
    fail(user, "gltf-limit",
         "the file asks for more than " + std::to_string(limit) + " vertices, indices and keys, which its " +
             std::to_string(total_bytes_) + " bytes do not account for",
         "let every primitive have accessors of its own");
  }
  spent_ += elements;
}

void Document::warn(std::string code, std::string message, const std::string& pointer, std::string hint) {
  if (!pointer.empty()) message = pointer + ": " + message;
  diagnostics_->warning(std::move(code), std::move(message), {path_, 0, 0, pointer}, std::move(hint));
}

void Document::note(std::string code, std::string message, const std::string& pointer) {
  if (!pointer.empty()) message = pointer + ": " + message;
  diagnostics_->add({Severity::note, std::move(code), std::move(message), {path_, 0, 0, pointer}, {}});
}

}  // namespace loom::scene::gltf
