// The facts that passes reflect on.
#include <gtest/gtest.h>

#include "scene/load.h"
#include "support/scene_builders.h"

namespace {

using loom::SceneFacts;
using loom::scene::compute_facts;
using loom::scene::Material;
using loom::scene::Scene;
using loom::scene::SurfaceModel;
using namespace loom::test;

TEST(Facts, AnEmptySceneHasNone) {
  const SceneFacts facts = compute_facts(empty_scene());
  EXPECT_EQ(facts.triangles, 0u);
  EXPECT_EQ(facts.lights(), 0);
  EXPECT_FALSE(facts.sky || facts.textures || facts.moves || facts.alpha_mask);
  EXPECT_EQ(facts.bounds_min, facts.bounds_max);
}

TEST(Facts, LightsByKindAndFaces) {
  Scene scene = empty_scene();
  add_point_light(scene, {0, 1, 0}, glm::vec3(0));
  add_spot_light(scene, {0, 1, 0}, {0, -1, 0}, glm::vec3(1), .1, 60 * 3.14159265358979 / 180 - 1e-9);
  add_spot_light(scene, {0, 1, 0}, {0, -1, 0}, glm::vec3(1), .1, 1.2);
  add_directional_light(scene, {0, -1, 0}, glm::vec3(1));
  const SceneFacts facts = compute_facts(scene);
  EXPECT_EQ(facts.point_lights, 1) << "a light of intensity 0 is a light";
  EXPECT_EQ(facts.spot_lights, 1);
  EXPECT_EQ(facts.wide_spot_lights, 1);
  EXPECT_EQ(facts.directional_lights, 1);
  EXPECT_EQ(facts.light_faces(), 6 + 1 + 6 + 1);
  EXPECT_EQ(facts.max_chroma, 0);
}

TEST(Facts, BoundsThicknessAndCounts) {
  Scene scene = empty_scene();
  const int grey = add_material(scene, diffuse(glm::vec3(.5f)));
  const int lamp = add_material(scene, diffuse(glm::vec3(.8f), glm::vec3(2)));
  add_box(scene, {-1, 0, -2}, {1, 3, 2}, grey);
  add_plane(scene, .25f, 2.75f, lamp, true);
  const SceneFacts facts = compute_facts(scene);
  EXPECT_EQ(facts.triangles, 14u);
  EXPECT_EQ(facts.emissive_triangles, 2);
  EXPECT_EQ(facts.bounds_min, glm::dvec3(-1, 0, -2));
  EXPECT_EQ(facts.bounds_max, glm::dvec3(1, 3, 2));
  EXPECT_EQ(facts.thinnest_feature, .5) << "flat meshes count by their sides";
  EXPECT_NEAR(facts.max_albedo, .8, 1e-7);
  EXPECT_EQ(facts.max_chroma, 0);
}

// Diffuse scenes stay as they were, hash and all, whatever their materials would be under ggx.
TEST(Facts, SpecularSurfacesAreAskedFor) {
  Scene scene = empty_scene();
  const int matte = add_material(scene, diffuse(glm::vec3(.5f)));
  Material glass = diffuse(glm::vec3(1));
  glass.transmission = .5f;
  add_plane(scene, 1, 0, matte);
  finish(scene);
  const auto plain = scene.content_hash;
  scene.materials.push_back(glass);
  finish(scene);
  const auto lambert = scene.content_hash;
  EXPECT_NE(lambert, plain);
  scene.materials.back().ior = 2;
  finish(scene);
  EXPECT_EQ(scene.content_hash, lambert) << "an index of refraction is nothing to diffuse surfaces";

  scene.surfaces = SurfaceModel::ggx;
  EXPECT_TRUE(compute_facts(scene).ggx);
  EXPECT_FALSE(compute_facts(scene).specular) << "nothing shows the glass, and the rest is matte";
  finish(scene);
  const auto dense = scene.content_hash;
  EXPECT_NE(dense, lambert);
  scene.materials.back().ior = 1.5f;
  finish(scene);
  EXPECT_NE(scene.content_hash, dense);

  add_plane(scene, 1, 1, static_cast<int>(scene.materials.size()) - 1);
  EXPECT_TRUE(compute_facts(scene).specular && compute_facts(scene).transmission);
  EXPECT_NEAR(compute_facts(scene).max_albedo, .5, 1e-7) << "what goes through is not reflected";
  scene.surfaces = SurfaceModel::lambert;
  EXPECT_FALSE(compute_facts(scene).specular || compute_facts(scene).transmission);
  EXPECT_NEAR(compute_facts(scene).max_albedo, 1, 1e-7);
}

TEST(Facts, ChromaOfEverySource) {
  const auto chroma = [](const auto& change) {
    Scene scene = empty_scene();
    const int material = add_material(scene, diffuse(glm::vec3(.5f)));
    add_plane(scene, 1, 0, material);
    change(scene);
    return compute_facts(scene).max_chroma;
  };
  EXPECT_EQ(chroma([](Scene&) {}), 0);
  EXPECT_NEAR(chroma([](Scene& s) { s.sky = {1, .75f, .5f}; }), .5, 1e-7);
  EXPECT_NEAR(chroma([](Scene& s) { add_point_light(s, {}, {4, 4, 3}); }), .25, 1e-7);
  EXPECT_NEAR(chroma([](Scene& s) { s.materials[1].base_color = {.5f, .5f, .4f, 1}; }), .2, 1e-6);
  EXPECT_NEAR(chroma([](Scene& s) { s.materials[1].emissive = {1, 0, 0}; }), 1, 1e-7);
  EXPECT_EQ(chroma([](Scene& s) { s.materials[0].base_color = {1, 0, 0, 1}; }), 0) << "nothing is made of it";
  EXPECT_NEAR(chroma([](Scene& s) { s.meshes[0].primitives[0].colors.assign(4, {1, 1, .9f, 1}); }), .1, 1e-6);
  EXPECT_EQ(chroma([](Scene& s) {
              s.materials[1].base_color = {1, 0, 0, 1};
              s.materials[1].metallic = 1;
            }),
            0)
      << "a metal has no diffuse albedo";
}

TEST(Facts, TexturesBoundAlbedoAndChroma) {
  Scene scene = empty_scene();
  loom::scene::Material material = diffuse({1, .5f, 1});
  scene.images.push_back({"two", 2, 1, {255, 255, 255, 255, 128, 128, 128, 255}});
  material.base_color_texture.image = 0;
  const int index = add_material(scene, material);
  add_plane(scene, 1, 0, index);
  const SceneFacts facts = compute_facts(scene);
  EXPECT_TRUE(facts.textures);
  EXPECT_NEAR(facts.max_albedo, 1, 1e-7);
  EXPECT_NEAR(facts.max_chroma, .5, 1e-7);
}

TEST(Builders, BoxesAndSpheresFaceAsTheySay) {
  for (const bool inward : {false, true}) {
    Scene scene = empty_scene();
    add_box(scene, glm::vec3(-1), glm::vec3(1), 0, inward);
    add_sphere(scene, glm::vec3(0), 1, 8, 0, inward);
    for (const loom::scene::Mesh& mesh : scene.meshes) {
      const loom::scene::Primitive& p = mesh.primitives.at(0);
      for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        const glm::vec3 a = p.positions[p.indices[i]];
        const glm::vec3 b = p.positions[p.indices[i + 1]];
        const glm::vec3 c = p.positions[p.indices[i + 2]];
        const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
        EXPECT_EQ(glm::dot(normal, a + b + c) < 0, inward);
        EXPECT_NEAR(glm::dot(normal, p.normals[p.indices[i]]), 1, 1e-6);
      }
    }
    EXPECT_EQ(compute_facts(scene).triangles, 12u + 2 * 16 * 7);
  }
}

}  // namespace
