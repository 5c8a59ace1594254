#pragma once
// Writes small glTF files for tests: JSON with one data: URI.
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace loom::test {

using Json = nlohmann::json;

inline std::string base64(const std::string& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

class GltfBuilder {
 public:
  /// Starts with one scene, one node and one mesh of one primitive; its attributes are still to be added.
  GltfBuilder() {
    json["asset"]["version"] = "2.0";
    json["scene"] = 0;
    json["scenes"] = Json::parse(R"([{"nodes": [0]}])");
    json["nodes"] = Json::parse(R"([{"mesh": 0}])");
    json["meshes"] = Json::parse(R"([{"primitives": [{"attributes": {}}]}])");
  }

  Json& primitive() { return json["meshes"][0]["primitives"][0]; }

  /// Appends an accessor with a bufferView of its own; `T` decides the component type. Returns its index.
  template <class T>
  int accessor(std::string_view type, int components, const std::vector<T>& values, bool normalized = false) {
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}});
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    Json accessor{{"bufferView", json["bufferViews"].size() - 1},
                  {"componentType", component_type(T{})},
                  {"count", values.size() / static_cast<std::size_t>(components)},
                  {"type", type}};
    if (normalized) accessor["normalized"] = true;
    json["accessors"].push_back(accessor);
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  GltfBuilder& positions(const std::vector<float>& values) {
    primitive()["attributes"]["POSITION"] = accessor("VEC3", 3, values);
    return *this;
  }
  /// A triangle in the plane z = 0 whose normal is +Z.
  GltfBuilder& triangle() { return positions({0, 0, 0, 1, 0, 0, 0, 1, 0}); }
  GltfBuilder& material(const std::string& text) {
    json["materials"].push_back(Json::parse(text));
    primitive()["material"] = json["materials"].size() - 1;
    return *this;
  }

  [[nodiscard]] std::string text() const {
    Json result = json;
    if (!bytes_.empty()) {
      result["buffers"] = Json::array(
          {{{"byteLength", bytes_.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}});
    }
    return result.dump();
  }

  Json json;

 private:
  static int component_type(std::int8_t) { return 5120; }
  static int component_type(std::uint8_t) { return 5121; }
  static int component_type(std::int16_t) { return 5122; }
  static int component_type(std::uint16_t) { return 5123; }
  static int component_type(std::uint32_t) { return 5125; }
  static int component_type(float) { return 5126; }
  std::string bytes_;
};

/// A PNG of 2 × 1 pixels: red, then blue.
inline constexpr std::string_view two_pixels =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAADUlEQVR4nGP4zwAE/wEHAAH/"
    "4iOeWQAAAABJRU5ErkJggg==";

}  // namespace loom::test
