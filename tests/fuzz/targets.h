#pragma once
// What hostile input is given to: one function for each kind of file. Each returns whatever the bytes are; a crash, a
// hang, a leak or an exception that is no loom::Error is the finding.
#include <cstddef>
#include <span>
#include <string_view>

namespace loom::fuzz {

using Bytes = std::span<const std::byte>;

void pipeline(Bytes bytes);  ///< a pipeline
void run_file(Bytes bytes);  ///< a run file
void gltf(Bytes bytes);      ///< a .gltf or .glb
void image(Bytes bytes);     ///< an .exr or .png, as `compare` reads it
void plugin(Bytes bytes);    ///< a plugin, up to the point where the dynamic linker would take over

struct Target {
  std::string_view name;  ///< also of its folder in corpus/ and its file in dictionaries/
  void (*run)(Bytes);
};
inline constexpr Target targets[] = {
    {"pipeline", pipeline}, {"run_file", run_file}, {"gltf", gltf}, {"image", image}, {"plugin", plugin}};

}  // namespace loom::fuzz
