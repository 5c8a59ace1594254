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

/// The path that a URI names after percent-decoding, relative to `folder`; empty where it has a scheme or is damaged,
/// and, unless `outside` is allowed, where it is absolute, climbs with "..", or goes through a symbolic link out of the
/// folder.
[[nodiscard]] std::optional<std::string> resolve_uri(std::string_view uri, const std::string& folder, bool outside);

/// All bytes of a file; empty where it cannot be read, is no regular file or is longer than `max_bytes`. `why` says
/// which.
[[nodiscard]] std::optional<std::vector<std::byte>> read_file(const std::string& path, std::size_t max_bytes,
                                                              std::string& why);

}  // namespace loom::scene::gltf
