#include "scene/content_hash.h"

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "scene/sky.h"

namespace loom::scene {
namespace {

/// Eight bytes at a time: multiply by an odd constant (2^64 over the golden ratio), then fold the high half down. Good
/// enough to tell scenes apart, and as fast as memory; nothing here is secret.
class Hash {
 public:
  void word(std::uint64_t value) {
    state_ = (state_ ^ value) * 0x9e3779b97f4a7c15u;
    state_ ^= state_ >> 32;
  }
  void bytes(const void* data, std::size_t size) {
    word(size);
    const auto* at = static_cast<const unsigned char*>(data);
    for (; size >= 8; size -= 8, at += 8) {
      std::uint64_t value = 0;
      std::memcpy(&value, at, 8);
      word(value);
    }
    std::uint64_t rest = 0;
    if (size > 0) std::memcpy(&rest, at, size);  // an empty vector has no address
    word(rest);
  }
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(&v, sizeof v);
  }
  template <class T>
  void values(const std::vector<T>& list) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(list.data(), list.size() * sizeof(T));
  }
  [[nodiscard]] std::uint64_t result() const { return state_; }

 private:
  std::uint64_t state_ = 0x2545f4914f6cdd1du;
};

void add(Hash& hash, const TextureRef& texture) {
  hash.value(texture.image);
  hash.value(texture.uv_set);
  hash.value(texture.transform);
  hash.word((texture.repeat_u ? 1u : 0u) | (texture.repeat_v ? 2u : 0u) | (texture.nearest ? 4u : 0u));
}

void add(Hash& hash, const Material& material) {
  hash.value(material.base_color);
  hash.value(material.metallic);
  hash.value(material.roughness);
  hash.value(material.emissive);
  hash.value(material.normal_scale);
  hash.value(material.alpha_cutoff);
  hash.word((material.alpha == AlphaMode::mask ? 1u : 0u) | (material.double_sided ? 2u : 0u));
  add(hash, material.base_color_texture);
  add(hash, material.metallic_roughness_texture);
  add(hash, material.normal_texture);
  add(hash, material.emissive_texture);
}

void add(Hash& hash, const Primitive& p) {
  hash.values(p.positions);
  hash.values(p.normals);
  hash.values(p.uv0);
  hash.values(p.uv1);
  hash.values(p.colors);
  hash.values(p.tangents);
  hash.values(p.joints);
  hash.values(p.weights);
  hash.values(p.rest_positions);
  hash.values(p.indices);
  hash.value(p.material);
}

void add(Hash& hash, const Light& light) {
  hash.value(light.kind);
  hash.value(light.position);
  hash.value(light.direction);
  hash.value(light.intensity);
  hash.value(light.inner_rad);
  hash.value(light.outer_rad);
}

void add(Hash& hash, const Camera& camera) {
  hash.value(camera.eye);
  hash.value(camera.target);
  hash.value(camera.up);
  hash.word(camera.orthographic ? 1 : 0);
  hash.value(camera.yfov_rad);
  hash.value(camera.ymag);
  hash.value(camera.xmag);
  hash.value(camera.znear);
}

void add_motion(Hash& hash, const Scene& scene) {
  for (const Node& node : scene.nodes) {
    hash.value(node.parent);
    hash.value(node.world);
    hash.value(node.skin);
  }
  for (const Skin& skin : scene.skins) {
    hash.values(skin.joints);
    hash.values(skin.inverse_bind);
  }
  for (const Animation& animation : scene.animations) {
    for (const Channel& channel : animation.channels) {
      hash.value(channel.node);
      hash.value(channel.path);
      hash.value(channel.interpolation);
      hash.values(channel.times);
      hash.values(channel.values);
    }
  }
}

}  // namespace

std::uint64_t content_hash(const Scene& scene) {
  // Images and meshes are most of it, and are hashed on all cores.
  std::vector<std::uint64_t> parts(scene.images.size() + scene.meshes.size());
  oneapi::tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    Hash hash;
    if (i < scene.images.size()) {
      const Image& image = scene.images[i];
      hash.value(image.width);
      hash.value(image.height);
      hash.values(image.rgba);
    } else {
      for (const Primitive& primitive : scene.meshes[i - scene.images.size()].primitives) add(hash, primitive);
    }
    parts[i] = hash.result();
  });
  Hash hash;
  hash.word(scene.images.size());
  hash.values(parts);
  for (const Material& material : scene.materials) add(hash, material);
  add_motion(hash, scene);
  for (const Instance& instance : scene.instances) {
    hash.value(instance.mesh);
    hash.value(instance.world);
  }
  for (const Light& light : scene.lights) add(hash, light);
  for (const Camera& camera : scene.cameras) add(hash, camera);
  hash.value(scene.sky);
  if (scene.sky_image) {
    hash.value(scene.sky_image->width);
    hash.value(scene.sky_image->height);
    hash.value(scene.sky_image->rotation_rad);
    hash.values(scene.sky_image->radiance);
  }
  if (scene.surfaces == SurfaceModel::lambert) return hash.result();  // nothing below is looked at then
  hash.value(scene.surfaces);
  for (const Material& material : scene.materials) {
    hash.value(material.ior);
    hash.value(material.transmission);
  }
  return hash.result();
}

}  // namespace loom::scene
