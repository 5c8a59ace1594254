// The loader against plugins that are wrong in every way it names, each beside a good one that must still load.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "loom/registry.h"
#include "plugins/library.h"
#include "plugins/loader.h"

namespace loom::plugins {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder of its own for each test, removed afterwards.
class Plugins : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::path(testing::TempDir()) /
           (std::string("loom_plugins_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(dir_);
    fs::create_directories(dir_);
    unsetenv("LOOM_PLUGIN_PATH");
    unsetenv("LOOM_SHADER_PATH");
  }
  void TearDown() override { fs::remove_all(dir_); }

  /// `name` of the plugins that were built, as `as`.so in the test's folder (or one below it).
  void put(const std::string& name, const std::string& as = {}, const std::string& folder = {}) const {
    fs::create_directories(dir_ / folder);
    fs::copy_file(fs::path(PLUGINS_DIR) / (name + ".so"), dir_ / folder / ((as.empty() ? name : as) + ".so"));
  }
  std::vector<LoadedPlugin> load(std::vector<std::string> folders = {""}) {
    SearchPath search{.dirs = {}, .installed = false};
    for (const std::string& folder : folders) search.dirs.push_back((dir_ / folder).string());
    return load_plugins(search, registry_, diagnostics_);
  }
  std::vector<std::string> pass_types() const {
    std::vector<std::string> names;
    for (const PassType& type : registry_.passes()) names.push_back(type.name);
    return names;
  }

  /// `bad` is refused with `code` by a message with `text`; the good plugin beside it loads.
  void expect_refused(const std::string& bad, const std::string& code, const std::string& text) {
    put("good", "a_good");
    put("same_bundle", "z_good");
    put(bad, "m_bad");
    const std::vector<LoadedPlugin> loaded = load();
    EXPECT_EQ(loaded.size(), 2u);
    EXPECT_THAT(pass_types(), testing::ElementsAre("Good", "SameBundle"));
    ASSERT_EQ(diagnostics_.all().size(), 1u);
    const Diagnostic& diagnostic = diagnostics_.all().front();
    EXPECT_EQ(diagnostic.code, code);
    EXPECT_EQ(diagnostic.severity, Severity::error);
    EXPECT_EQ(diagnostic.where.file, (dir_ / "m_bad.so").string());
    EXPECT_THAT(diagnostic.message, HasSubstr(text));
    EXPECT_FALSE(diagnostic.hint.empty());
  }

  fs::path dir_;
  Registry registry_;
  Diagnostics diagnostics_;
};

TEST_F(Plugins, GoodOnesLoadByNameInOrder) {
  put("same_bundle", "b");
  put("good", "a");
  const std::vector<LoadedPlugin> loaded = load();
  ASSERT_EQ(loaded.size(), 2u);
  EXPECT_EQ(loaded[0].name, "good");
  EXPECT_EQ(loaded[0].path, (dir_ / "a.so").string());
  EXPECT_EQ(loaded[1].name, "same_bundle");
  EXPECT_TRUE(diagnostics_.all().empty());
  const PassType* good = registry_.pass("Good");
  ASSERT_NE(good, nullptr);
  EXPECT_EQ(good->plugin, (dir_ / "a.so").string());
  EXPECT_NE(good->create(), nullptr);
  EXPECT_NE(registry_.bundle("GoodBundle"), nullptr);
}

TEST_F(Plugins, MissingSymbol) { expect_refused("missing_symbol", "plugin-load", "a_function_that_nobody_defines"); }
TEST_F(Plugins, MissingDependency) { expect_refused("missing_dependency", "plugin-load", "libabsent.so"); }
TEST_F(Plugins, LoadErrorsNameBothVersions) {
  const std::string version = "ABI " + std::to_string(plugin_abi) + ", build " + LOOM_BUILD_TAG;
  expect_refused("missing_symbol", "plugin-load", "plugin: " + version + "; this Lightloom: " + version);
}
TEST_F(Plugins, WrongAbi) {
  expect_refused("wrong_abi", "plugin-abi",
                 "ABI " + std::to_string(plugin_abi + 41) + ", this Lightloom has ABI " + std::to_string(plugin_abi));
}
TEST_F(Plugins, WrongStructSize) {
  expect_refused(
      "wrong_struct_size", "plugin-abi",
      std::to_string(sizeof(LoomPlugin) + 8) + " bytes, this Lightloom's has " + std::to_string(sizeof(LoomPlugin)));
}
TEST_F(Plugins, WrongBuildTag) {
  expect_refused("wrong_build_tag", "plugin-build",
                 std::string("built as Elbrus-1.0, this Lightloom as ") + LOOM_BUILD_TAG);
}
TEST_F(Plugins, AnotherAbiIsSeenBeforeAnythingRuns) {
  expect_refused("wrong_stamp", "plugin-abi", "ABI " + std::to_string(plugin_abi + 7));
}
TEST_F(Plugins, NoSymbol) { expect_refused("no_symbol", "plugin-symbol", "loom_plugin()"); }
TEST_F(Plugins, NoStruct) { expect_refused("null_struct", "plugin-symbol", "returned nothing"); }
TEST_F(Plugins, DuplicateType) {
  expect_refused("duplicate_type", "duplicate-type", (dir_ / "a_good.so").string());
  EXPECT_THAT(diagnostics_.all().front().message, HasSubstr((dir_ / "m_bad.so").string()));
  EXPECT_EQ(registry_.bundle("BeforeDuplicateBundle"), nullptr);
}
TEST_F(Plugins, BundleConflict) {
  expect_refused("bundle_conflict", "bundle-conflict", "GoodBundle");
  EXPECT_EQ(registry_.bundle("GoodBundle")->members.front().name, "a");
}
TEST_F(Plugins, ThrowingConstructor) {
  expect_refused("throwing_constructor", "plugin-throws", "the constructor gave up");
}
TEST_F(Plugins, ThrowingRegistration) { expect_refused("throwing_registration", "plugin-throws", "no std::exception"); }

TEST_F(Plugins, FileThatIsNoLibrary) {
  put("good");
  std::ofstream(dir_ / "text.so") << "not a library\n";
  std::ofstream(dir_ / "empty.so");
  std::ofstream(dir_ / "notes.txt") << "no plugin, and not looked at\n";
  EXPECT_EQ(load().size(), 1u);
  ASSERT_EQ(diagnostics_.all().size(), 2u);
  EXPECT_EQ(diagnostics_.all()[0].code, "plugin-load");
  EXPECT_EQ(diagnostics_.all()[0].where.file, (dir_ / "empty.so").string());
  EXPECT_EQ(diagnostics_.all()[1].code, "plugin-load");
  EXPECT_EQ(diagnostics_.all()[1].where.file, (dir_ / "text.so").string());
}

TEST_F(Plugins, TruncatedLibrary) {
  put("good");
  put("same_bundle", "cut");
  fs::resize_file(dir_ / "cut.so", fs::file_size(dir_ / "cut.so") / 8);
  EXPECT_EQ(load().size(), 1u);
  ASSERT_EQ(diagnostics_.all().size(), 1u);
  EXPECT_EQ(diagnostics_.all()[0].code, "plugin-load");
}

TEST_F(Plugins, LinkThatLeadsNowhere) {
  put("good");
  fs::create_symlink(dir_ / "gone.so", dir_ / "link.so");
  EXPECT_EQ(load().size(), 1u);
  ASSERT_EQ(diagnostics_.all().size(), 1u);
  EXPECT_EQ(diagnostics_.all()[0].code, "plugin-load");
}

TEST_F(Plugins, OneFileByTwoFoldersIsOnePlugin) {
  put("good", "", "real");
  fs::create_directories(dir_ / "other");
  fs::create_symlink(dir_ / "real" / "good.so", dir_ / "other" / "renamed.so");
  EXPECT_EQ(load({"real", "other", "real"}).size(), 1u);
  EXPECT_TRUE(diagnostics_.all().empty());
}

TEST_F(Plugins, CopyInASecondFolderIsADuplicate) {
  put("good", "", "first");
  put("good", "", "second");
  const std::vector<LoadedPlugin> loaded = load({"first", "second"});
  ASSERT_EQ(loaded.size(), 1u);
  EXPECT_EQ(loaded[0].path, (dir_ / "first" / "good.so").string());
  ASSERT_EQ(diagnostics_.all().size(), 1u);
  EXPECT_EQ(diagnostics_.all()[0].code, "duplicate-type");
}

TEST_F(Plugins, FolderThatIsMissingIsNamedWhereItWasAskedFor) {
  load({"nowhere"});
  ASSERT_EQ(diagnostics_.all().size(), 1u);
  EXPECT_EQ(diagnostics_.all()[0].code, "plugin-dir");
  EXPECT_EQ(diagnostics_.all()[0].where.file, (dir_ / "nowhere").string());
}

TEST_F(Plugins, VariableNamesFurtherFolders) {
  put("good", "", "one");
  put("same_bundle", "", "two");
  setenv("LOOM_PLUGIN_PATH", ((dir_ / "one").string() + "::" + (dir_ / "two").string()).c_str(), 1);
  const std::vector<LoadedPlugin> loaded = load_plugins({.dirs = {}, .installed = false}, registry_, diagnostics_);
  unsetenv("LOOM_PLUGIN_PATH");
  EXPECT_EQ(loaded.size(), 2u);
  EXPECT_TRUE(diagnostics_.all().empty());
}

TEST_F(Plugins, ShaderRootsAreVariableThenPluginsThenInstalled) {
  fs::create_directories(dir_ / "plugin" / "shaders");
  fs::create_directories(dir_ / "own");
  setenv("LOOM_SHADER_PATH", (dir_ / "own").c_str(), 1);
  const std::vector<std::string> roots = shader_roots({.dirs = {(dir_ / "plugin").string()}});
  unsetenv("LOOM_SHADER_PATH");
  ASSERT_EQ(roots.size(), 3u);
  EXPECT_EQ(roots[0], (dir_ / "own").string());
  EXPECT_EQ(roots[1], (dir_ / "plugin" / "shaders").string());
  EXPECT_EQ(roots[2], data_dir() + "/shaders");
}

TEST_F(Plugins, RegistryKeepsLibrariesAlive) {
  put("good");
  std::unique_ptr<Pass> pass;
  {
    Registry inner;
    load_plugins({.dirs = {dir_.string()}, .installed = false}, inner, diagnostics_);
    Registry moved = std::move(inner);
    pass = moved.pass("Good")->create();
    EXPECT_NE(pass, nullptr);
    pass.reset();  // while its code is loaded
  }
  // A second registry loads the library again.
  EXPECT_EQ(load().size(), 1u);
}

TEST_F(Plugins, StampCanBeReadWithoutLoading) {
  const auto version = stamped_version(std::string(PLUGINS_DIR) + "/good.so");
  ASSERT_TRUE(version);
  EXPECT_EQ(version->abi, plugin_abi);
  EXPECT_EQ(version->build_tag, LOOM_BUILD_TAG);
  EXPECT_FALSE(stamped_version(std::string(PLUGINS_DIR) + "/no_symbol.so"));
  EXPECT_FALSE(stamped_version("no such file"));
}

}  // namespace
}  // namespace loom::plugins
