#include "scene/gpu_scene.h"

#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gpu/current.h"
#include "gpu/debug.h"
#include "interop/light.h"
#include "interop/scene.h"
#include "loom/diagnostic.h"
#include "loom/facts.h"
#include "loom/gpu.h"
#include "scene/bvh.h"
#include "scene/emitters.h"
#include "scene/gpu_materials.h"
#include "scene/gpu_sky.h"
#include "scene/gpu_textures.h"
#include "scene/load.h"
#include "scene/packed.h"
#include "scene/sky.h"

namespace loom::scene {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// A storage buffer of the items; throws where the device cannot bind so many bytes at once.
template <class T>
std::optional<Buffer> storage_of(const std::vector<T>& items, std::string_view label) {
  if (items.empty()) return std::nullopt;
  GLint64 largest = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest);
  const std::size_t bytes = items.size() * sizeof(T);
  if (bytes > static_cast<std::size_t>(largest)) {
    throw Error(std::string(label) + " takes " + std::to_string(bytes) + " bytes for this scene; this device binds " +
                std::to_string(largest) + " at most: use a scene with fewer triangles");
  }
  return Buffer::of(std::span<const T>(items), label);
}

const Buffer* address(const std::optional<Buffer>& buffer) { return buffer ? &*buffer : nullptr; }

class VertexArray {
 public:
  VertexArray() { glCreateVertexArrays(1, &name_); }
  ~VertexArray() {
    if (gpu::current_context() != nullptr) glDeleteVertexArrays(1, &name_);
  }
  VertexArray(const VertexArray&) = delete;
  VertexArray& operator=(const VertexArray&) = delete;
  [[nodiscard]] GlName name() const { return name_; }

  /// Attribute `index`: floats at `offset` of binding 0.
  void floats(GLuint index, GLint components, std::size_t offset) const {
    glEnableVertexArrayAttrib(name_, index);
    glVertexArrayAttribFormat(name_, index, components, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
    glVertexArrayAttribBinding(name_, index, 0);
  }
  /// Attribute `index`: one uint an instance from binding 1.
  void instance_index(GLuint index) const {
    glEnableVertexArrayAttrib(name_, index);
    glVertexArrayAttribIFormat(name_, index, 1, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(name_, index, 1);
  }

 private:
  GlName name_ = 0;
};

/// Vertices, indices, draws and commands of the scene's triangles.
class Geometry {
 public:
  explicit Geometry(const Scene& scene) : packed_(pack(scene)) {
    for (const PrimitiveRange& range : packed_.ranges) skinned_ = skinned_ || !range.primitive->joints.empty();
    records_ = draw_records(scene, packed_);
    draws_ = storage_of(records_, "scene_draws");
    if (!draws_) return;
    triangles_ = storage_of(packed_.triangle_normals, "scene_triangles");
    vertices_ = Buffer::of(std::span<const Vertex>(packed_.vertices), "scene vertices");
    indices_ = Buffer::of(std::span<const std::uint32_t>(packed_.indices), "scene indices");
    std::vector<std::uint32_t> numbers(records_.size());
    for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
    draw_numbers_ = Buffer::of(std::span<const std::uint32_t>(numbers), "scene draw numbers");
    array_.floats(0, 3, offsetof(Vertex, position));
    array_.floats(1, 3, offsetof(Vertex, normal));
    array_.floats(2, 4, offsetof(Vertex, uv));
    array_.floats(3, 4, offsetof(Vertex, color));
    array_.floats(4, 4, offsetof(Vertex, tangent));
    array_.instance_index(5);
    glVertexArrayVertexBuffer(array_.name(), 0, vertices_->name(), 0, sizeof(Vertex));
    glVertexArrayVertexBuffer(array_.name(), 1, draw_numbers_->name(), 0, sizeof(std::uint32_t));
    glVertexArrayElementBuffer(array_.name(), indices_->name());
    packed_.indices = {};
    if (!skinned_) {
      packed_.vertices = {};
      packed_.triangle_normals = {};
    }
  }

  struct Change {
    bool any = false;
    bool still = false;  ///< of something that no animation moves
    void note(bool moves) {
      any = true;
      still = still || !moves;
    }
  };

  Change update(const Scene& scene) {
    Change change;
    std::vector<interop::Draw> records = draw_records(scene, packed_);
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (std::memcmp(&records[i], &records_[i], sizeof(interop::Draw)) != 0) change.note(packed_.draws[i].moves);
    }
    if (change.any) {
      records_ = std::move(records);
      draws_->write(std::as_bytes(std::span(records_)));
    }
    // A range that a skin moves is one instance's alone, and has one draw at most.
    for (const DrawSource& draw : packed_.draws) {
      const PrimitiveRange& range = packed_.ranges[draw.range];
      if (!range.primitive->joints.empty() && update_skinned(range)) change.note(draw.moves);
    }
    return change;
  }

  void draw(const Program& program, const Scene& scene, const MaterialTextures& textures, int instances, Surfaces which,
            Motion motion) const {
    if (!draws_ || instances < 1) return;
    glUseProgram(program.name());
    glDisable(GL_CULL_FACE);
    glFrontFace(GL_CCW);
    glBindVertexArray(array_.name());
    // gl_InstanceID counts the copies; the draw's number must stand still over them.
    glVertexArrayBindingDivisor(array_.name(), 1, static_cast<GLuint>(instances));
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands(instances).name());
    std::vector<std::pair<const MaterialSampler*, GLuint>> units;
    for (const auto& resource : program.interface().samplers) {
      for (const MaterialSampler& sampler : material_samplers) {
        if (resource.name == sampler.name)
          units.emplace_back(&sampler, static_cast<GLuint>(resource.location_or_binding));
      }
    }
    for (const Batch& batch : packed_.batches) {
      const Material& material = scene.materials[static_cast<std::size_t>(batch.material)];
      const bool masked = material.alpha == AlphaMode::mask;
      if (which != Surfaces::all && masked != (which == Surfaces::masked)) continue;
      if (motion != Motion::any && batch.moves != (motion == Motion::moving)) continue;
      for (const auto& [sampler, unit] : units) {
        const MaterialTextures::Binding binding = textures.binding(material.*sampler->ref, sampler->encoding);
        glBindTextureUnit(unit, binding.texture);
        glBindSampler(unit, binding.sampler);
      }
      // An offset into the bound buffer, which the call takes as a pointer.
      const auto* offset = reinterpret_cast<const void*>(batch.first * sizeof(DrawCommand));
      glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, offset, static_cast<GLsizei>(batch.count), 0);
    }
    // A sampler object left bound would override the filter of whatever texture comes next.
    for (const auto& [sampler, unit] : units) glBindSampler(unit, 0);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
    glBindVertexArray(0);
  }

  [[nodiscard]] const Buffer* draws() const { return address(draws_); }
  [[nodiscard]] const Buffer* triangles() const { return address(triangles_); }

 private:
  bool update_skinned(const PrimitiveRange& range) {
    const std::size_t count = range.primitive->positions.size();
    const auto vertices = std::span(packed_.vertices).subspan(range.first_vertex, count);
    const auto normals =
        std::span(packed_.triangle_normals).subspan(range.first_triangle, range.primitive->indices.size() / 3);
    const std::vector<Vertex> before(vertices.begin(), vertices.end());
    pack_primitive(range, packed_);
    if (count == 0 || std::memcmp(before.data(), vertices.data(), vertices.size_bytes()) == 0) return false;
    vertices_->write(std::as_bytes(vertices), range.first_vertex * sizeof(Vertex));
    if (!normals.empty()) triangles_->write(std::as_bytes(normals), range.first_triangle * sizeof(glm::vec4));
    return true;
  }

  const Buffer& commands(int instances) const {
    const auto found = commands_.find(instances);
    if (found != commands_.end()) return found->second;
    std::vector<DrawCommand> list = packed_.commands;
    for (DrawCommand& command : list) command.instances = static_cast<std::uint32_t>(instances);
    return commands_.emplace(instances, Buffer::of(std::span<const DrawCommand>(list), "scene draw commands"))
        .first->second;
  }

  Packed packed_;
  bool skinned_ = false;
  std::vector<interop::Draw> records_;
  VertexArray array_;
  std::optional<Buffer> vertices_, indices_, draw_numbers_, draws_, triangles_;
  mutable std::map<int, Buffer> commands_;  ///< by number of copies; made on first use
};

class GpuSceneImpl final : public GpuScene {
 public:
  explicit GpuSceneImpl(const Scene& scene)
      : scene_(scene),
        facts_(compute_facts(scene)),
        textures_(scene),
        geometry_(std::in_place, scene),
        material_records_(material_records(scene)),
        materials_(storage_of(material_records_, "scene_materials")),
        alpha_(make_alpha_layers(scene)),
        instances_(scene.instances.size()) {
    update_lights();
  }

  void update() override {
    update_lights();
    Geometry::Change change{.any = true, .still = true};
    if (scene_.instances.size() != instances_) {
      geometry_.emplace(scene_);
      instances_ = scene_.instances.size();
    } else {
      change = geometry_->update(scene_);
    }
    if (!change.any) return;
    ++geometry_version_;
    if (change.still) ++still_version_;
    emitters_.reset();
    bvh_.reset();
  }

  [[nodiscard]] const SceneFacts& facts() const override { return facts_; }
  [[nodiscard]] std::span<const interop::Light> lights() const override { return light_records_; }
  [[nodiscard]] glm::vec3 sky_radiance() const override { return scene_.sky; }
  [[nodiscard]] double sky_rotation() const override { return scene_.sky_image ? scene_.sky_image->rotation_rad : 0; }
  [[nodiscard]] std::vector<glm::dvec3> sky_harmonics(int order) const override {
    return scene::sky_harmonics(scene_, order);
  }
  [[nodiscard]] std::uint64_t geometry_version() const override { return geometry_version_; }
  [[nodiscard]] std::uint64_t lights_version() const override { return lights_version_; }
  [[nodiscard]] const Scene* cpu_scene() const override { return &scene_; }

  [[nodiscard]] std::uint64_t still_version() const override { return still_version_; }

  void draw(const Program& program, int instances, Surfaces which, Motion motion) const override {
    geometry_->draw(program, scene_, textures_, instances, which, motion);
  }

  [[nodiscard]] const Buffer* buffer(std::string_view block) const override {
    if (block == "scene_draws") return geometry_->draws();
    if (block == "scene_triangles") return geometry_->triangles();
    if (block == "scene_materials") return address(materials_);
    if (block == "scene_lights") return address(lights_);
    if (block == "scene_emitters") return address(emitters());
    if (block == "scene_bvh_nodes") return address(bvh().nodes);
    if (block == "scene_bvh_triangles") return address(bvh().triangles);
    return nullptr;
  }

  [[nodiscard]] const Texture* texture(std::string_view sampler) const override {
    if (sampler == "scene_sky") return sky_texture_ ? &*sky_texture_ : nullptr;
    return sampler == "scene_alpha" && alpha_ ? &*alpha_ : nullptr;
  }

 private:
  struct GpuBvh {
    std::optional<Buffer> nodes, triangles;
  };

  void update_lights() {
    std::vector<interop::Light> records = light_records(scene_);
    const bool same = same_bytes(records, light_records_) && sky_ == scene_.sky && sky_image_ == scene_.sky_image;
    if (same && lights_version_ > 0) return;
    ++lights_version_;
    sky_ = scene_.sky;
    if (sky_image_ != scene_.sky_image) sky_texture_ = make_sky_texture(scene_);
    sky_image_ = scene_.sky_image;
    light_records_ = std::move(records);
    lights_ = storage_of(light_records_, "scene_lights");
  }

  const std::optional<Buffer>& emitters() const {
    if (!emitters_) emitters_.emplace(storage_of(build_emitters(scene_), "scene_emitters"));
    return *emitters_;
  }

  const GpuBvh& bvh() const {
    if (bvh_) return *bvh_;
    const Bvh built = build_bvh(scene_);
    bvh_.emplace(
        GpuBvh{storage_of(built.nodes, "scene_bvh_nodes"), storage_of(built.triangles, "scene_bvh_triangles")});
    fill_mean_albedo();
    return *bvh_;
  }

  /// Only ray hits read it, and it visits every texel: made with the BVH, once.
  void fill_mean_albedo() const {
    if (has_mean_albedo_ || !materials_) return;
    has_mean_albedo_ = true;
    tbb::parallel_for(std::size_t{0}, material_records_.size(), [this](std::size_t i) {
      material_records_[i].mean_albedo = glm::vec4(mean_albedo(scene_, scene_.materials[i]), 0);
    });
    materials_->write(std::as_bytes(std::span(material_records_)));
  }

  const Scene& scene_;
  SceneFacts facts_;
  MaterialTextures textures_;
  std::optional<Geometry> geometry_;
  mutable std::vector<interop::Material> material_records_;
  std::optional<Buffer> materials_;
  std::optional<Texture> alpha_;
  std::size_t instances_;
  std::vector<interop::Light> light_records_;
  std::optional<Buffer> lights_;
  glm::vec3 sky_{0};
  std::shared_ptr<const SkyImage> sky_image_;
  std::optional<Texture> sky_texture_;
  std::uint64_t geometry_version_ = 1, still_version_ = 1, lights_version_ = 0;
  mutable bool has_mean_albedo_ = false;
  mutable std::optional<std::optional<Buffer>> emitters_;  ///< outer: built; inner: there are any
  mutable std::optional<GpuBvh> bvh_;
};

}  // namespace

std::unique_ptr<GpuScene> GpuScene::create(const Scene& scene) { return std::make_unique<GpuSceneImpl>(scene); }

}  // namespace loom::scene
