// Diagnostics, names, formats, ports, registry.
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "loom/diagnostic.h"
#include "loom/formats.h"
#include "loom/ports.h"
#include "loom/registry.h"

namespace loom {
namespace {

TEST(Diagnostic, ReadsAsCompilersWriteThem) {
  EXPECT_EQ(to_string({Severity::error, "unknown-type", "there is no `GBufer`", {"a.json", 3, 14, "/x"}, "look"}),
            "a.json:3:14: error[unknown-type]: there is no `GBufer`\n  hint: look");
  EXPECT_EQ(to_string({Severity::warning, "w", "m", {"a.json", 0, 0, {}}, {}}), "a.json: warning[w]: m");
  EXPECT_EQ(to_string({Severity::note, "n", "m", {}, {}}), "note[n]: m");
}

TEST(Diagnostic, OnlyErrorsCountAsErrors) {
  Diagnostics diagnostics;
  diagnostics.warning("w", "m");
  EXPECT_FALSE(diagnostics.has_errors());
  diagnostics.error("e", "m");
  EXPECT_TRUE(diagnostics.has_errors());
}

TEST(Diagnostic, ErrorsAlwaysCarryOne) {
  EXPECT_EQ(Error("no memory").diagnostics().all().at(0).code, "failed");
  EXPECT_STREQ(Error("no memory").what(), "no memory");
  EXPECT_EQ(Error(Diagnostics{}).diagnostics().all().size(), 1U);
  const BadInput bad({Severity::error, "file-missing", "gone", {"x", 0, 0, {}}, {}});
  EXPECT_STREQ(bad.what(), "x: error[file-missing]: gone");
}

TEST(NearestName, FindsTypingErrorsOnly) {
  const std::vector<std::string> names = {"GBuffer", "GatherRSM", "GatherVolume", "RSM", "Add"};
  EXPECT_EQ(nearest_name("GBufer", names), "GBuffer");
  EXPECT_EQ(nearest_name("gbuffer", names), "GBuffer");
  EXPECT_EQ(nearest_name("GatherVolmue", names), "GatherVolume");
  EXPECT_EQ(nearest_name("RMS", names), "RSM");
  EXPECT_EQ(nearest_name("Voxelize", names), "");
  EXPECT_EQ(nearest_name("XYZ", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("a", {}), "");
}

TEST(Formats, NamesGoBothWays) {
  for (int i = 0; i <= static_cast<int>(Format::depth32f); ++i) {
    const auto format = static_cast<Format>(i);
    EXPECT_EQ(format_from(to_string(format)), format);
    EXPECT_GT(bytes_per_texel(format), 0U);
  }
  EXPECT_FALSE(format_from("rgb16f").has_value());
  EXPECT_TRUE(is_depth(Format::depth32f));
  EXPECT_FALSE(is_depth(Format::r32f));
  EXPECT_TRUE(is_integer(Format::rg32ui));
  EXPECT_FALSE(is_integer(Format::rgba8));
}

TEST(Formats, SizesCountLayersSlicesAndMips) {
  EXPECT_EQ(byte_size(TextureDesc::image({4, 2}, Format::rgba16f)), 64U);
  EXPECT_EQ(byte_size(TextureDesc::volume(4, Format::r32f)), 256U);
  EXPECT_EQ(byte_size(TextureDesc::layers({4, 4}, 3, Format::r8)), 48U);
  auto mipped = TextureDesc::image({4, 2}, Format::r8);
  mipped.mips = 3;
  EXPECT_EQ(byte_size(mipped), 8U + 2 + 1);
  auto volume = TextureDesc::volume(4, Format::r8);
  volume.mips = 2;
  EXPECT_EQ(byte_size(volume), 64U + 8);
  EXPECT_EQ(byte_size(TextureDesc::image({16384, 16384}, Format::rgba32f)), 4294967296U);
}

TEST(Formats, ReadWell) {
  EXPECT_EQ(to_string(TextureDesc::image({512, 256}, Format::rgba16f)), "rgba16f 512x256");
  EXPECT_EQ(to_string(TextureDesc::layers({256, 256}, 6, Format::r32f)), "r32f 256x256 x6");
  EXPECT_EQ(to_string(TextureDesc::volume(32, Format::rgba16f)), "rgba16f 32x32x32");
}

TEST(Ports, InputsKnowWhatTheirWireBrings) {
  BundleInfo info{.type = "Image"};
  info.members.push_back({.name = "image", .desc = TextureDesc::image({8, 4}, Format::r32f)});
  info.attributes = {{"bands", 3}, {"basis", std::string("sg")}};
  BundleInfo nothing{.type = "Image", .absent = "no lights"};
  Ports ports({64, 32}, {{"a", info}, {"b", nothing}}, [](std::string_view rule) { return rule != "off"; });

  const InputPort a = ports.in("a", "Image");
  EXPECT_TRUE(a.connected());
  EXPECT_FALSE(a.absent());
  EXPECT_EQ(a.texture("image")->width, 8);
  EXPECT_EQ(a.texture("depth"), nullptr);
  EXPECT_EQ(a.attribute("bands", 2), 3);
  EXPECT_EQ(a.attribute("cascades", 1), 1);
  EXPECT_EQ(a.attribute("basis", "sh"), "sg");
  EXPECT_EQ(a.attribute("bands", "text"), "text") << "another kind of attribute is not that attribute";

  const InputPort b = ports.in("b", "Image");
  EXPECT_TRUE(b.connected());
  EXPECT_TRUE(b.absent());
  EXPECT_EQ(b.why_absent(), "no lights");
  EXPECT_EQ(b.texture("image"), nullptr);

  const InputPort c = ports.in("c", "Image");
  EXPECT_FALSE(c.connected());
  EXPECT_TRUE(c.absent());
  EXPECT_EQ(c.why_absent(), "input `c` is not wired");

  EXPECT_TRUE(ports.rule("on"));
  EXPECT_FALSE(ports.rule("off"));
}

TEST(Ports, ClearingWhatIsNotDeclaredIsAnError) {
  Ports ports({1, 1}, {});
  auto out = ports.out("image", "Image");
  EXPECT_THROW(out.cleared("image"), Error);
}

class Nothing : public Pass {
 public:
  void reflect(Ports& /*ports*/, const SceneFacts& /*facts*/) override {}
  void execute(Frame& /*frame*/, const Bindings& /*bindings*/) override {}
};

TEST(Registry, ListsPassesByNameAndRefusesTwoOfOneName) {
  Registry registry;
  registry.set_current_plugin("a.so");
  registry.add<Nothing>("Zeta", "z");
  registry.add<Nothing>("Alpha", "a");
  ASSERT_EQ(registry.passes().size(), 2U);
  EXPECT_EQ(registry.passes()[0].name, "Alpha");
  registry.set_current_plugin("b.so");
  try {
    registry.add<Nothing>("Zeta", "z");
    FAIL() << "a second Zeta was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnostics().all()[0].code, "duplicate-type");
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("a.so"), testing::HasSubstr("b.so")));
  }
  registry.remove_plugin("a.so");
  EXPECT_EQ(registry.pass("Zeta"), nullptr);
}

TEST(Registry, MergesEqualBundlesAndRefusesConflicts) {
  Registry registry;
  const std::size_t builtin = registry.bundles().size();
  BundleType type{.name = "Moments", .members = {{"m", MemberKind::texture, "m", "moments"}}, .struct_bytes = 16};
  registry.add_bundle(type, "a.so");
  type.doc = "other prose";
  registry.add_bundle(type, "b.so");
  EXPECT_EQ(registry.bundles().size(), builtin + 1);
  type.struct_bytes = 32;
  try {
    registry.add_bundle(type, "c.so");
    FAIL() << "a conflicting bundle was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnostics().all()[0].code, "bundle-conflict");
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("a.so"), testing::HasSubstr("c.so")));
  }
  registry.remove_plugin("a.so");
  EXPECT_EQ(registry.bundle("Moments"), nullptr);
  EXPECT_NE(registry.bundle("Surface"), nullptr);
}

TEST(Registry, ReleasesLibrariesAfterTheTypesTheyBrought) {
  struct Library {
    bool* unloaded;
    ~Library() { *unloaded = true; }
  };
  bool unloaded = false;
  bool type_alive_after_unload = false;
  struct Probe {
    bool *unloaded, *bad;
    ~Probe() { *bad = *bad || *unloaded; }
  };
  {
    Registry registry;
    registry.keep(std::shared_ptr<void>(new Library{&unloaded}, [](void* p) { delete static_cast<Library*>(p); }));
    auto probe = std::make_shared<Probe>(Probe{&unloaded, &type_alive_after_unload});
    registry.add_pass({.name = "P", .create = [probe] { return std::unique_ptr<Pass>(); }});
  }
  EXPECT_TRUE(unloaded);
  EXPECT_FALSE(type_alive_after_unload);
}

}  // namespace
}  // namespace loom
