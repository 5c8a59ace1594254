#pragma once
// The scene as the GPU reads it, made on the CPU: packed vertices, draws sorted by material, lights.
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/light.h"
#include "interop/scene.h"
#include "scene/scene.h"

namespace loom::scene {

/// Attributes 0–4 of shaders/lib/scene_vertex.glsl, in this order. What a primitive lacks is 0, colour is white.
struct Vertex {
  glm::vec3 position;
  glm::vec3 normal;
  glm::vec4 uv;  ///< xy: set 0, zw: set 1
  glm::vec4 color;
  glm::vec4 tangent;
};

/// As glMultiDrawElementsIndirect reads it.
struct DrawCommand {
  std::uint32_t count = 0, instances = 1, first_index = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t base_instance = 0;  ///< the draw's index, by way of the instanced attribute draw_index
};

/// Where a primitive of a mesh lies in the buffers.
struct PrimitiveRange {
  const Primitive* primitive = nullptr;
  std::size_t first_vertex = 0, first_index = 0, first_triangle = 0;
};

/// One primitive of one instance; what the draw records are made of.
struct DrawSource {
  std::size_t instance = 0;
  std::size_t range = 0;  ///< index into Packed::ranges
  int material = 0;
  bool moves = false;  ///< the animation can move it
};

/// Consecutive draws that bind the same textures and either can all move or cannot.
struct Batch {
  int material = 0;  ///< whose textures they are
  bool moves = false;
  std::size_t first = 0, count = 0;
};

struct Packed {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<glm::vec4> triangle_normals;  ///< xyz: unit, in the primitive's space, counter-clockwise; w: 0
  std::vector<PrimitiveRange> ranges;
  std::vector<DrawSource> draws;  ///< opaque ones first, then by material
  std::vector<DrawCommand> commands;
  std::vector<Batch> batches;
};

/// Geometry that no instance shows is left out.
Packed pack(const Scene& scene);
/// Vertices and triangle normals of one primitive again, in place, after a skin has moved it.
void pack_primitive(const PrimitiveRange& range, Packed& packed);
/// The draw records, at the instances' present places.
std::vector<interop::Draw> draw_records(const Scene& scene, const Packed& packed);

/// The lights with the light faces (layers) that each takes: six for a point light and for a spot wider than 60°
/// half-angle, else one.
std::vector<interop::Light> light_records(const Scene& scene);

}  // namespace loom::scene
