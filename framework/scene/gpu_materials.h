#pragma once
// Materials as shaders read them, and the alpha of masked ones for ray queries.
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "interop/scene.h"
#include "loom/gpu.h"
#include "scene/scene.h"

namespace loom::scene {

/// All but mean_albedo, which is 0. Layers of scene_alpha go to the masked materials in order.
std::vector<interop::Material> material_records(const Scene& scene);

/// Diffuse albedo of a material, its textures averaged (over what the mask leaves): the mean of the base colour times
/// one minus the mean of metallic. Vertex colours are left out.
glm::vec3 mean_albedo(const Scene& scene, const Material& material);

/// r8, one layer for each masked material: the alpha of its base-colour texture, resampled to one size of at most 512².
/// Empty where no material is masked.
std::optional<Texture> make_alpha_layers(const Scene& scene);

/// One layer of it: means over the footprint where the image is larger, bilinear where it is smaller; row 0 is v = 0.
std::vector<std::uint8_t> resample_alpha(const Image& image, glm::ivec2 size);

}  // namespace loom::scene
