// What glTF means, on files of a few triangles.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "files.h"
#include "gltf_builder.h"
#include "scene/geometry.h"
#include "scene/load.h"
#include "support/temp_dir.h"

namespace {

using loom::Diagnostics;
using loom::scene::AlphaMode;
using loom::scene::Material;
using loom::scene::Primitive;
using loom::scene::Scene;
using loom::test::GltfBuilder;
using loom::test::Json;
using loom::test::TempDir;
using testing::HasSubstr;

class Gltf : public testing::Test {
 protected:
  Scene load(const GltfBuilder& builder) {
    diagnostics_ = Diagnostics();
    return loom::scene::load_gltf(temp_.write("test.gltf", builder.text()), diagnostics_);
  }
  [[nodiscard]] std::string said() const {
    std::string text;
    for (const loom::Diagnostic& d : diagnostics_.all()) text += to_string(d) + "\n";
    return text;
  }
  TempDir temp_;
  Diagnostics diagnostics_;
};

glm::dvec3 face_normal(const Primitive& p, std::size_t triangle) {
  const glm::dvec3 a(p.positions[p.indices[3 * triangle]]);
  const glm::dvec3 b(p.positions[p.indices[3 * triangle + 1]]);
  const glm::dvec3 c(p.positions[p.indices[3 * triangle + 2]]);
  return glm::normalize(glm::cross(b - a, c - a));
}

TEST_F(Gltf, StripsAndFansFaceTheSameWay) {
  for (const int mode : {5, 6}) {
    GltfBuilder builder;
    if (mode == 5) {
      builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
    } else {
      builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0});
    }
    builder.primitive()["mode"] = mode;
    const Scene scene = load(builder);
    const Primitive& p = scene.meshes.at(0).primitives.at(0);
    ASSERT_EQ(p.indices.size(), 9u) << mode;
    for (std::size_t t = 0; t < 3; ++t) EXPECT_EQ(face_normal(p, t), glm::dvec3(0, 0, 1)) << mode << ", " << t;
  }
}

TEST_F(Gltf, PointsAndLinesAreLeftOutWithAWarning) {
  for (const int mode : {0, 1, 2, 3}) {
    GltfBuilder builder;
    builder.triangle().primitive()["mode"] = mode;
    EXPECT_TRUE(load(builder).instances.empty());
    EXPECT_THAT(said(), HasSubstr("points or lines"));
  }
}

TEST_F(Gltf, MissingNormalsAreFlat) {
  GltfBuilder builder;
  builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  builder.primitive()["indices"] = builder.accessor<std::uint8_t>("SCALAR", 1, {0, 1, 2, 0, 3, 1});
  const Scene scene = load(builder);
  const Primitive& p = scene.meshes.at(0).primitives.at(0);
  ASSERT_EQ(p.positions.size(), 6u) << "vertices of flat faces are unshared";
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(p.normals[i], i < 3 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0));
}

TEST_F(Gltf, MendsWhatCannotBeDrawn) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  GltfBuilder builder;
  builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0, 2, 0, 0});
  builder.primitive()["attributes"]["NORMAL"] =
      builder.accessor<float>("VEC3", 3, {0, 0, 2, 0, 0, 0, nan, 0, 0, 0, 0, 1, 0, 0, 1});
  // The second has a vertex that is no number, the third lies on a line.
  builder.primitive()["indices"] = builder.accessor<std::uint16_t>("SCALAR", 1, {0, 1, 2, 0, 1, 3, 0, 1, 4});
  const Scene scene = load(builder);
  const Primitive& p = scene.meshes.at(0).primitives.at(0);
  EXPECT_EQ(p.indices.size(), 3u);
  ASSERT_EQ(p.positions.size(), 3u) << "nothing may still hold what is not finite";
  for (const glm::vec3& normal : p.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
  EXPECT_THAT(said(), HasSubstr("1 triangle(s) with a vertex that is not finite"));
  EXPECT_THAT(said(), HasSubstr("1 triangle(s) without area"));
  EXPECT_THAT(said(), HasSubstr("2 normal(s) of no length"));
}

TEST_F(Gltf, NormalizedAndQuantizedComponents) {
  GltfBuilder builder;
  builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  // Rows of four bytes, as the extension wants them.
  builder.primitive()["attributes"]["POSITION"] =
      builder.accessor<std::int8_t>("VEC3", 3, {0, 0, 0, 0, 127, 0, 0, 0, -128, -128, 0, 0}, true);
  builder.json["accessors"][0]["count"] = 3;
  builder.json["bufferViews"][0]["byteStride"] = 4;
  builder.primitive()["attributes"]["COLOR_0"] =
      builder.accessor<std::uint16_t>("VEC4", 4, {65535, 0, 0, 32768, 0, 0, 0, 0, 0, 0, 0, 0}, true);
  const Scene scene = load(builder);
  const Primitive& p = scene.meshes.at(0).primitives.at(0);
  EXPECT_EQ(p.positions.at(0), glm::vec3(0));
  EXPECT_EQ(p.positions.at(1), glm::vec3(1, 0, 0));
  EXPECT_EQ(p.positions.at(2), glm::vec3(-1, -1, 0)) << "−128 is held at −1";
  EXPECT_EQ(p.colors.at(0), glm::vec4(1, 0, 0, 32768.0f / 65535));
}

TEST_F(Gltf, VertexColorsWithoutAlphaAreOpaqueAndHeldAtOne) {
  GltfBuilder builder;
  builder.triangle().primitive()["attributes"]["COLOR_0"] =
      builder.accessor<float>("VEC3", 3, {2, .5f, -1, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(load(builder).meshes.at(0).primitives.at(0).colors.at(0), glm::vec4(1, .5f, 0, 1));
}

TEST_F(Gltf, NoMaterialIsNeutralAndSaidSo) {
  GltfBuilder builder;
  builder.triangle();
  const Scene scene = load(builder);
  const Material& m = scene.materials.at(static_cast<std::size_t>(scene.meshes.at(0).primitives.at(0).material));
  EXPECT_EQ(m.base_color, glm::vec4(1));
  EXPECT_EQ(m.metallic, 0);
  EXPECT_THAT(said(), HasSubstr("no material"));
}

TEST_F(Gltf, ADeclaredMaterialIsAMetalByDefault) {
  GltfBuilder builder;
  builder.triangle().material(R"({"name": "plain"})");
  EXPECT_EQ(load(builder).materials.at(0).metallic, 1);
  EXPECT_THAT(said(), HasSubstr("\"plain\" is a metal"));
}

TEST_F(Gltf, SpecularGlossinessKeepsItsDiffusePart) {
  GltfBuilder builder;
  builder.triangle().material(R"({"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]},
    "extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.25, 0.5, 0.75, 1], "glossinessFactor": 0.25}}})");
  const Material m = load(builder).materials.at(0);
  EXPECT_EQ(m.base_color, glm::vec4(.25f, .5f, .75f, 1));
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, .75f);
}

TEST_F(Gltf, DielectricsHaveAnIndexAndAShareThatIsTransmitted) {
  GltfBuilder builder;
  builder.triangle().material(R"({"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {
    "KHR_materials_ior": {"ior": 1.25}, "KHR_materials_transmission": {"transmissionFactor": 1.5}}})");
  const Material m = load(builder).materials.at(0);
  EXPECT_EQ(m.ior, 1.25f);
  EXPECT_EQ(m.transmission, 1) << "held within its range";
  EXPECT_THAT(said(), HasSubstr("transmissionFactor"));
  EXPECT_EQ(Material{}.ior, 1.5f);
}

TEST_F(Gltf, EmissionIsFactorTimesStrength) {
  GltfBuilder builder;
  builder.triangle().material(R"({"emissiveFactor": [1, 0.5, 0],
    "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 20}}})");
  EXPECT_EQ(load(builder).materials.at(0).emissive, glm::vec3(20, 10, 0));
}

TEST_F(Gltf, AlphaModes) {
  GltfBuilder mask;
  mask.triangle().material(R"({"alphaMode": "MASK", "alphaCutoff": 0.25})");
  EXPECT_EQ(load(mask).materials.at(0).alpha, AlphaMode::mask);
  EXPECT_EQ(load(mask).materials.at(0).alpha_cutoff, .25f);
  GltfBuilder blend;
  blend.triangle().material(R"({"alphaMode": "BLEND", "alphaCutoff": 0.25, "name": "glass"})");
  EXPECT_EQ(load(blend).materials.at(0).alpha, AlphaMode::mask);
  EXPECT_EQ(load(blend).materials.at(0).alpha_cutoff, .5f);
  EXPECT_THAT(said(), HasSubstr("\"glass\" counts as opaque where its alpha is .5 or more"));
}

GltfBuilder textured(const std::string& info, const std::string& sampler = "{}") {
  GltfBuilder builder;
  builder.triangle();
  for (const char* set : {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2", "TEXCOORD_3"}) {
    const float base = static_cast<float>(set[9] - '0');
    builder.primitive()["attributes"][set] = builder.accessor<float>("VEC2", 2, {base, 0, base, 1, base, 2});
  }
  builder.json["images"] = Json::array({{{"uri", loom::test::two_pixels}}});
  builder.json["samplers"] = Json::array({Json::parse(sampler)});
  builder.json["textures"] = Json::parse(R"([{"source": 0, "sampler": 0}])");
  builder.material(R"({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": )" + info + "}}");
  return builder;
}

TEST_F(Gltf, TextureTransformAndItsOwnSet) {
  const Scene scene = load(textured(R"({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform":
    {"offset": [0.5, 0.25], "scale": [2, 4], "rotation": 1.5707963267948966, "texCoord": 3}}})"));
  const loom::scene::TextureRef& ref = scene.materials.at(0).base_color_texture;
  // T·R·S: (1, 0) is scaled to (2, 0) and turned counter-clockwise with v downwards, to (0, −2).
  const glm::vec2 u = ref.transform * glm::vec3(1, 0, 1);
  const glm::vec2 v = ref.transform * glm::vec3(0, 1, 1);
  EXPECT_NEAR(u.x, .5, 1e-6);
  EXPECT_NEAR(u.y, .25 - 2, 1e-6);
  EXPECT_NEAR(v.x, .5 + 4, 1e-6);
  EXPECT_NEAR(v.y, .25, 1e-6);
  // Set 3 is the only one that is read.
  EXPECT_EQ(ref.uv_set, 0);
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).uv0.at(1), glm::vec2(3, 1));
}

TEST_F(Gltf, TheSecondSetKeepsItsPlace) {
  const Scene scene = load(textured(R"({"index": 0, "texCoord": 1})"));
  EXPECT_EQ(scene.materials.at(0).base_color_texture.uv_set, 1);
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).uv0.at(0), glm::vec2(0, 0));
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).uv1.at(0), glm::vec2(1, 0));
}

TEST_F(Gltf, MirroredRepeatIsAnImageOfBothTiles) {
  const Scene scene = load(textured(R"({"index": 0})", R"({"wrapS": 33648, "wrapT": 33071, "magFilter": 9728})"));
  const loom::scene::TextureRef& ref = scene.materials.at(0).base_color_texture;
  const loom::scene::Image& image = scene.images.at(0);
  ASSERT_EQ(image.width, 4);
  ASSERT_EQ(image.height, 1);
  const auto is_red = [&](std::size_t x) { return image.rgba[4 * x] == 255 && image.rgba[4 * x + 2] == 0; };
  EXPECT_TRUE(is_red(0) && !is_red(1) && !is_red(2) && is_red(3));
  EXPECT_EQ(glm::vec2(ref.transform * glm::vec3(1, 1, 1)), glm::vec2(.5f, 1));
  EXPECT_TRUE(ref.repeat_u);
  EXPECT_FALSE(ref.repeat_v);
  EXPECT_TRUE(ref.nearest);
}

TEST_F(Gltf, AMissingImageLeavesTheFactor) {
  GltfBuilder builder = textured(R"({"index": 0})");
  builder.json["images"][0]["uri"] = "absent.png";
  const Scene scene = load(builder);
  EXPECT_EQ(scene.materials.at(0).base_color_texture.image, -1);
  EXPECT_THAT(said(), HasSubstr("absent.png does not exist"));
}

TEST_F(Gltf, AnImageMayNotClaimMoreThanItsBytesHold) {
  // 16384 × 16384 pixels, 1 GiB decoded, in under a hundred bytes.
  GltfBuilder builder = textured(R"({"index": 0})");
  builder.json["images"][0]["uri"] =
      "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAQAAAAEAACAIAAAAmqofTAAAADUlEQVR4nGP4zwAE/wEHAAH/"
      "4iOeWQAAAABJRU5ErkJggg==";
  EXPECT_EQ(load(builder).materials.at(0).base_color_texture.image, -1);
  EXPECT_THAT(said(), HasSubstr("more than its bytes can hold"));
}

TEST_F(Gltf, PercentEncodedNamesAreFound) {
  GltfBuilder builder;
  builder.triangle();
  Json json = Json::parse(builder.text());
  const std::string bytes(json["buffers"][0]["byteLength"].get<std::size_t>(), '\0');
  temp_.write("my data/a#b.bin", bytes);
  json["buffers"][0]["uri"] = "my%20data/a%23b.bin";
  EXPECT_NO_THROW((void)loom::scene::load_gltf(temp_.write("named.gltf", json.dump()), diagnostics_));
}

TEST_F(Gltf, TangentsAreMadeWhereANormalMapNeedsThem) {
  GltfBuilder builder = textured(R"({"index": 0})");
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.accessor<float>("VEC2", 2, {0, 1, 1, 1, 0, 0});
  builder.json["materials"][0]["normalTexture"] = Json::parse(R"({"index": 0, "scale": 0.5})");
  const Scene scene = load(builder);
  EXPECT_EQ(scene.materials.at(0).normal_scale, .5f);
  // u runs along +x and v against +y = n × t, as in an image that is not mirrored.
  for (const glm::vec4& tangent : scene.meshes.at(0).primitives.at(0).tangents)
    EXPECT_EQ(tangent, glm::vec4(1, 0, 0, 1));
}

TEST_F(Gltf, MadeTangentsAgreeWithThoseOfAnExporter) {
  const std::filesystem::path file = loom::test::scenes_folder() / "gltf-features/suzanne/02_suzanne.gltf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "absent: $LOOM_SCENES/gltf-features/suzanne";
  const Scene scene = loom::scene::load_gltf(file.string(), diagnostics_);
  Primitive p = scene.meshes.at(0).primitives.at(0);
  const std::vector<glm::vec4> exported = p.tangents;
  ASSERT_FALSE(exported.empty());
  loom::scene::make_tangents(p, p.uv0);
  std::size_t same = 0;
  for (std::size_t i = 0; i < exported.size(); ++i) {
    if (glm::dot(glm::vec3(exported[i]), glm::vec3(p.tangents[i])) > .9f && exported[i].w == p.tangents[i].w) ++same;
  }
  // Weights differ from MikkTSpace's, which shows at the seams.
  EXPECT_GT(static_cast<double>(same), .97 * static_cast<double>(exported.size()));
}

TEST_F(Gltf, NegativeScaleKeepsTheWindingForTheReaderToTurn) {
  GltfBuilder builder;
  builder.triangle().json["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene scene = load(builder);
  EXPECT_LT(glm::determinant(scene.instances.at(0).world), 0);
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).normals.at(0), glm::vec3(0, 0, 1));
}

TEST_F(Gltf, HiddenNodesAreNotDrawn) {
  GltfBuilder builder;
  builder.triangle().json["nodes"] =
      Json::parse(R"([{"children": [1], "extensions": {"KHR_node_visibility": {"visible": false}}}, {"mesh": 0}])");
  EXPECT_TRUE(load(builder).instances.empty());
}

TEST_F(Gltf, UsedExtensionsThatAreLeftOutAreNamed) {
  GltfBuilder builder;
  builder.triangle().json["extensionsUsed"] = {"EXT_made_up", "KHR_materials_clearcoat", "KHR_materials_variants"};
  (void)load(builder);
  EXPECT_THAT(said(), HasSubstr("EXT_made_up is not supported"));
  EXPECT_THAT(said(), HasSubstr("KHR_materials_clearcoat is left out"));
  EXPECT_THAT(said(), testing::Not(HasSubstr("KHR_materials_variants")));
}

TEST_F(Gltf, MorphTargetsWithWeightAreSaidToBeLeftOut) {
  GltfBuilder builder;
  builder.triangle().primitive()["targets"] = Json::parse(R"([{"POSITION": 0}])");
  builder.json["meshes"][0]["weights"] = {.5};
  (void)load(builder);
  EXPECT_THAT(said(), HasSubstr("morph targets are not supported"));
}

TEST_F(Gltf, PrimitivesShareOneSetOfVertices) {
  GltfBuilder builder;
  builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  Json second = builder.primitive();
  builder.primitive()["indices"] = builder.accessor<std::uint8_t>("SCALAR", 1, {0, 1, 2});
  second["indices"] = builder.accessor<std::uint8_t>("SCALAR", 1, {0, 3, 1});
  builder.json["meshes"][0]["primitives"].push_back(second);
  const Scene scene = load(builder);
  const Primitive& p = scene.meshes.at(0).primitives.at(1);
  ASSERT_EQ(p.positions.size(), 3u);
  EXPECT_EQ(p.positions[p.indices[1]], glm::vec3(0, 0, 1));
}

TEST_F(Gltf, EqualFilesHaveEqualHashes) {
  GltfBuilder builder;
  builder.triangle();
  const std::uint64_t hash = load(builder).content_hash;
  EXPECT_EQ(load(builder).content_hash, hash);
  builder.json["nodes"][0]["translation"] = {0, 0, 1e-6};
  EXPECT_NE(load(builder).content_hash, hash);
}

}  // namespace
