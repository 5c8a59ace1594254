#pragma once
// URIs of a glTF file: data: URIs are decoded, relative ones are resolved within the file's own folder, nothing else is
// followed.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace loom::scene::gltf {

[[nodiscard]] bool is_data_uri(std::string_view uri);
/// The bytes of `data:<type>;base64,<text>`; empty where it is damaged.
[[nodiscard]] std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);

/// The path of a relative URI after percent-decoding, below `folder`; empty where it is absolute, has a scheme, climbs
/// with "..", or is damaged. Symbolic links are followed: what they point to is the owner's of the folder to answer
/// for.
[[nodiscard]] std::optional<std::string> resolve_uri(std::string_view uri, const std::string& folder);

/// All bytes of a file; empty where it cannot be read, is no regular file or is longer than `max_bytes`. `why` says
/// which.
[[nodiscard]] std::optional<std::vector<std::byte>> read_file(const std::string& path, std::size_t max_bytes,
                                                              std::string& why);

}  // namespace loom::scene::gltf
