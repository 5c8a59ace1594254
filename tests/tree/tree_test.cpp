// The shape of the source tree: which folder may include which, and what the program loads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "support/process.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

const fs::path source = LOOM_SOURCE_DIR;

/// What stands between the quotes (or, with `angled`, the angle brackets) of the #include lines of a file.
std::vector<std::string> includes(const fs::path& file, bool angled) {
  std::vector<std::string> names;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::string start = angled ? "#include <" : "#include \"";
    if (line.rfind(start, 0) != 0) continue;
    const std::size_t end = line.find(angled ? '>' : '"', start.size());
    const std::string name = line.substr(start.size(), end - start.size());
    if (name.find(".glsl") == std::string::npos) names.push_back(name);  // GLSL, in a string
  }
  return names;
}

std::vector<fs::path> cpp_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".cpp" || extension == ".h" || extension == ".inc") files.push_back(entry.path());
  }
  return files;
}

bool starts_with_any(const std::string& name, const std::vector<std::string>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(), [&](const auto& prefix) { return name.rfind(prefix, 0) == 0; });
}

TEST(Tree, ArrowsPointOneWay) {
  // core <- graph/compile; core <- gpu <- scene <- {graph/run, reference} <- plugins <- {measure, embed} <- cli, viewer
  const std::vector<std::string> base = {"loom/", "interop/", "core/"};
  const auto and_ = [](std::vector<std::string> list, const std::vector<std::string>& more) {
    list.insert(list.end(), more.begin(), more.end());
    return list;
  };
  const std::vector<std::string> compile = and_(base, {"graph/compile/"});
  const std::vector<std::string> gpu = and_(base, {"gpu/"});
  const std::vector<std::string> scene = and_(gpu, {"scene/"});
  const std::vector<std::string> run = and_(scene, {"graph/compile/", "graph/run/"});
  const std::vector<std::string> reference = and_(scene, {"reference/"});
  const std::vector<std::string> plugins = and_(run, {"reference/", "plugins/"});
  const std::vector<std::string> top = and_(plugins, {"embed/", "measure/"});
  const std::map<std::string, std::vector<std::string>> allowed = {
      {"include", {"loom/", "interop/"}},
      {"core", base},
      {"graph/compile", compile},
      {"gpu", gpu},
      {"scene", scene},
      {"graph/run", run},
      {"reference", reference},
      {"plugins", plugins},
      {"embed", and_(plugins, {"embed/"})},
      {"measure", and_(plugins, {"measure/"})},
      {"cli", and_(top, {"cli/", "viewer/entry.h"})},  // what it needs to know to load the library
      {"viewer", and_(top, {"viewer/"})},
  };
  std::size_t seen = 0;
  for (const auto& [folder, prefixes] : allowed) {
    for (const fs::path& file : cpp_files(source / "framework" / folder)) {
      for (const std::string& name : includes(file, false)) {
        ++seen;
        EXPECT_TRUE(starts_with_any(name, prefixes)) << fs::relative(file, source) << " includes " << name;
      }
    }
  }
  EXPECT_GT(seen, 100u);
  // Every folder is one of these.
  for (const auto& entry : fs::directory_iterator(source / "framework")) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || name == "cmake" || name == "graph") continue;
    EXPECT_TRUE(allowed.contains(name)) << "framework/" << name << " has no place in the order";
  }
}

TEST(Tree, PassesSeeThePublicHeadersAlone) {
  std::size_t seen = 0;
  for (const auto& pass : fs::directory_iterator(source / "passes")) {
    if (!pass.is_directory()) continue;
    const std::string name = pass.path().filename().string();
    std::vector<std::string> prefixes = {"loom/", "interop/"};
    if (name == "reference") prefixes.insert(prefixes.end(), {"reference/", "scene/"});
    for (const fs::path& file : cpp_files(pass.path())) {
      for (const std::string& included : includes(file, false)) {
        ++seen;
        // A header beside the pass has no folder.
        EXPECT_TRUE(starts_with_any(included, prefixes) || included.find('/') == std::string::npos ||
                    included.rfind(name + "/", 0) == 0)
            << fs::relative(file, source) << " includes " << included;
      }
    }
  }
  EXPECT_GT(seen, 10u);
}

TEST(Tree, TheCompilerAndThePublicHeadersKnowNoOpenGL) {
  for (const char* folder : {"framework/include", "framework/core", "framework/graph/compile"}) {
    for (const fs::path& file : cpp_files(source / folder)) {
      for (const std::string& name : includes(file, true)) {
        EXPECT_FALSE(starts_with_any(name, {"epoxy/", "GL/", "EGL/", "GLES"}))
            << fs::relative(file, source) << " includes " << name;
      }
    }
  }
}

TEST(Tree, TheProgramLoadsNoWindowSystem) {
  const ProcessResult result = run_process("/usr/bin/ldd", {LOOM_BINARY_DIR "/bin/loom"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, testing::HasSubstr("libloom.so"));
  for (const char* library : {"imgui", "glfw", "libX11", "libxcb", "libGLX", "wayland"}) {
    EXPECT_THAT(result.out, testing::Not(testing::HasSubstr(library)));
  }
}

}  // namespace
}  // namespace loom::test
