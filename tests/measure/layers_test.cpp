// Which layer is compared with which.
#include "measure/layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "loom/diagnostic.h"
#include "measure/images.h"

namespace loom::measure {
namespace {

using test::exr;
using test::uniform;
using testing::ElementsAre;
using testing::HasSubstr;

ImageFile with(ImageLayers image, const std::string& quantity, const std::string& output = {},
               const std::string& path = "a.exr") {
  if (!quantity.empty()) image.attributes["loom:quantity"] = quantity;
  if (!output.empty()) image.attributes["loom:output"] = output;
  return exr(std::move(image), path);
}

ImageFile plain(const std::string& quantity, const std::string& output = {}, const std::string& path = "a.exr") {
  return with(uniform(4, 3, glm::vec3(1)), quantity, output, path);
}

/// A file of the path tracer.
ImageFile reference() {
  ImageLayers image = uniform(4, 3, glm::vec3(1));
  for (const char* prefix : {"direct.", "emitter.", "bounce.", "indirect.", "albedo.", "normal."}) {
    image.channels.merge(test::make_image(
                             4, 3, [](int, int) { return glm::vec3(2); }, prefix)
                             .channels);
  }
  image.channels["depth.Z"].assign(12, 5);
  return with(std::move(image), "radiance", {}, "ref.exr");
}

std::string picked(const ImageFile& a, const ImageFile& r, const std::optional<std::string>& choice = std::nullopt) {
  const LayerPair pair = match_layers(a, r, choice);
  return pair.a.name + ":" + pair.reference.name;
}

Diagnostic refusal(const ImageFile& a, const ImageFile& r, const std::optional<std::string>& choice = std::nullopt) {
  try {
    const LayerPair pair = match_layers(a, r, choice);
    ADD_FAILURE() << "accepted as " << pair.a.name << ":" << pair.reference.name;
    return {};
  } catch (const BadInput& error) {
    return error.diagnostics().all().front();
  }
}

TEST(Layers, NamesAreListedOnce) {
  EXPECT_THAT(layer_names(reference().image),
              ElementsAre("RGB", "albedo", "bounce", "depth", "direct", "emitter", "indirect", "normal"));
}

TEST(Layers, ABareChannelIsALayerWhereThereIsNoRgb) {
  ImageLayers image{.width = 4, .height = 3, .channels = {}, .attributes = {}};
  image.channels["Z"].assign(12, 1);
  EXPECT_THAT(layer_names(image), ElementsAre("Z"));
  EXPECT_EQ(picked(exr(image), reference(), "Z:depth"), "Z:depth");
  EXPECT_THAT(refusal(exr(image), reference()).message, HasSubstr("no layer `RGB`, but Z"));
}

TEST(Layers, AreFoundByNamePrefixAndChannel) {
  const ImageFile file = reference();
  EXPECT_THAT(find_layer(file, "").channels, ElementsAre("R", "G", "B"));
  EXPECT_THAT(find_layer(file, "rgb").channels, ElementsAre("R", "G", "B"));
  EXPECT_THAT(find_layer(file, "bounce").channels, ElementsAre("bounce.R", "bounce.G", "bounce.B"));
  EXPECT_THAT(find_layer(file, "depth").channels, ElementsAre("depth.Z"));
  EXPECT_THAT(find_layer(file, "bounce.G").channels, ElementsAre("bounce.G"));
  EXPECT_EQ(find_layer(file, "bounce").planes[1][0], 2);
  EXPECT_TRUE(find_layer(file, "bounce").is_color());
  EXPECT_FALSE(find_layer(file, "normal").is_color());
  EXPECT_FALSE(find_layer(file, "depth").is_color());
}

TEST(Layers, AMissingOneIsAnErrorThatListsWhatThereIs) {
  const Diagnostic d = refusal(plain(""), reference(), "RGB:indrect");
  EXPECT_EQ(d.code, "missing-layer");
  EXPECT_EQ(d.where.file, "ref.exr");
  EXPECT_THAT(d.message, HasSubstr("RGB, albedo, bounce, depth, direct, emitter, indirect, normal"));
  EXPECT_THAT(d.hint, HasSubstr("indirect"));
}

TEST(Layers, TheQuantityPicksTheLayerOfTheReference) {
  const ImageFile r = reference();
  EXPECT_EQ(picked(plain(""), r), "RGB:RGB");
  EXPECT_EQ(picked(plain("radiance"), r), "RGB:RGB");
  EXPECT_EQ(picked(plain("irradiance"), r), "RGB:indirect");
  EXPECT_EQ(picked(plain("irradiance", "indirect"), r), "RGB:indirect");
  EXPECT_EQ(picked(plain("irradiance", "bounce"), r), "RGB:bounce");
  EXPECT_EQ(picked(plain("irradiance", "direct.irradiance.irradiance"), r), "RGB:direct");
  EXPECT_EQ(picked(plain("albedo"), r), "RGB:albedo");
  EXPECT_EQ(picked(plain("bounce"), r), "RGB:bounce");
  EXPECT_EQ(picked(plain("", "indirect"), r), "RGB:indirect") << "an output that carries nothing";
  EXPECT_EQ(picked(plain("", "hdr"), r), "RGB:RGB");
}

TEST(Layers, AOneChannelQuantityIsComparedOnItsFirstChannel) {
  const LayerPair pair = match_layers(plain("depth"), reference());
  EXPECT_THAT(pair.a.channels, ElementsAre("R"));
  EXPECT_THAT(pair.reference.channels, ElementsAre("depth.Z"));
}

TEST(Layers, TwoRendersOfOneQuantityAreCompared) {
  EXPECT_EQ(picked(plain("irradiance"), plain("irradiance")), "RGB:RGB");
  EXPECT_EQ(picked(plain("irradiance", "bounce"), plain("irradiance", "bounce")), "RGB:RGB");
  EXPECT_EQ(picked(plain("irradiance"), plain("")), "RGB:RGB");
  EXPECT_EQ(picked(plain("display"), plain("display")), "RGB:RGB");
}

TEST(Layers, QuantitiesThatDifferAreRefused) {
  const ImageFile png{.path = "a.png", .image = uniform(4, 3, glm::vec3(1)), .hdr = false};
  EXPECT_EQ(refusal(plain("radiance"), plain("irradiance")).code, "quantity-mismatch");
  EXPECT_EQ(refusal(plain("irradiance"), plain("radiance")).code, "quantity-mismatch");
  EXPECT_EQ(refusal(plain("irradiance", "bounce"), plain("irradiance", "indirect")).code, "quantity-mismatch");
  EXPECT_EQ(refusal(plain("display"), reference()).code, "quantity-mismatch");
  EXPECT_EQ(refusal(png, reference()).code, "quantity-mismatch");
  const Diagnostic d = refusal(plain("roughness"), reference());
  EXPECT_THAT(d.message, HasSubstr("a.exr holds roughness, and ref.exr holds radiance"));
  EXPECT_THAT(d.hint, HasSubstr("--layer A:REF"));
}

TEST(Layers, AnExplicitChoiceInsists) {
  const ImageFile r = reference();
  EXPECT_EQ(picked(plain("display"), r, "RGB:RGB"), "RGB:RGB");
  EXPECT_EQ(picked(plain("radiance"), r, ":indirect"), "RGB:indirect");
  EXPECT_EQ(picked(r, r, "emitter"), "emitter:emitter");
  EXPECT_EQ(picked(r, r, "direct:bounce"), "direct:bounce");
  EXPECT_EQ(refusal(plain(""), r, "RGB:depth").code, "channel-mismatch");
  EXPECT_EQ(picked(plain(""), r, "R:depth"), "R:depth");
}

TEST(Layers, SizesThatDifferAreRefusedWithBoth) {
  const Diagnostic d = refusal(exr(uniform(4, 4, glm::vec3(1))), reference());
  EXPECT_EQ(d.code, "size-mismatch");
  EXPECT_THAT(d.message, HasSubstr("4x4"));
  EXPECT_THAT(d.message, HasSubstr("4x3"));
}

}  // namespace
}  // namespace loom::measure
