// EXT_meshopt_compression.
#include <meshoptimizer.h>

#include "scene/gltf/document.h"

namespace loom::scene::gltf {

std::vector<std::byte> Document::decode_meshopt(const View& view) {
  const Meshopt& packed = *view.meshopt;
  const auto refuse = [&](const std::string& why) { fail(view.pointer, "gltf-compression", why); };
  const bool attributes = packed.mode == "ATTRIBUTES";
  const bool triangles = packed.mode == "TRIANGLES";
  if (!attributes && !triangles && packed.mode != "INDICES") refuse("has an unknown mode \"" + packed.mode + "\"");
  if (attributes ? packed.stride % 4 != 0 : packed.stride != 2 && packed.stride != 4) {
    refuse("has a byteStride that its mode does not allow");
  }
  if (triangles && packed.count % 3 != 0) refuse("has a count that is no multiple of 3");
  // What the codecs can reach at best: a vertex block spends 2 bits on 16 bytes of a plane, an index code 1 byte on a
  // triangle or an index. More than that is no honest stream, and must not be allocated.
  constexpr std::size_t best_ratio = 64;
  constexpr std::size_t one_block = 8192;
  if (view.length / best_ratio > packed.length + one_block) refuse("declares more data than its bytes can hold");

  const Bytes source = buffer(packed.buffer).subspan(packed.offset, packed.length);
  const auto* bytes = reinterpret_cast<const unsigned char*>(source.data());
  std::vector<std::byte> result(view.length);
  int status = 0;
  if (attributes) {
    status = meshopt_decodeVertexBuffer(result.data(), packed.count, packed.stride, bytes, source.size());
  } else if (triangles) {
    status = meshopt_decodeIndexBuffer(result.data(), packed.count, packed.stride, bytes, source.size());
  } else {
    status = meshopt_decodeIndexSequence(result.data(), packed.count, packed.stride, bytes, source.size());
  }
  if (status != 0) refuse("is no valid meshopt stream");

  if (packed.filter == "NONE") return result;
  if (!attributes) refuse("has a filter, which only mode ATTRIBUTES may have");
  if (packed.filter == "OCTAHEDRAL" && (packed.stride == 4 || packed.stride == 8)) {
    meshopt_decodeFilterOct(result.data(), packed.count, packed.stride);
  } else if (packed.filter == "QUATERNION" && packed.stride == 8) {
    meshopt_decodeFilterQuat(result.data(), packed.count, packed.stride);
  } else if (packed.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(result.data(), packed.count, packed.stride);
  } else {
    refuse("has an unknown filter \"" + packed.filter + "\" or one that its byteStride does not allow");
  }
  return result;
}

}  // namespace loom::scene::gltf
