// Damaged and hostile glTF: an error that the user can act on or a warning, never a crash, and no memory by a number in
// the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "files.h"
#include "scene/load.h"
#include "support/temp_dir.h"

namespace {

namespace fs = std::filesystem;
using loom::BadInput;
using loom::Diagnostics;
using loom::test::TempDir;
using testing::HasSubstr;

struct Outcome {
  bool refused = false;
  std::size_t complaints = 0;  ///< errors and warnings
  std::string text;
};

Outcome load(const std::string& path) {
  Outcome outcome;
  Diagnostics diagnostics;
  try {
    const loom::scene::Scene scene = loom::scene::load_gltf(path, diagnostics);
    (void)loom::scene::compute_facts(scene);
  } catch (const BadInput& error) {
    outcome.refused = true;
    diagnostics.append(error.diagnostics());
  }
  for (const loom::Diagnostic& d : diagnostics.all()) {
    if (d.severity != loom::Severity::note) ++outcome.complaints;
    outcome.text += to_string(d) + "\n";
  }
  return outcome;
}

std::vector<std::string> files_below(const fs::path& folder) {
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".gltf" || extension == ".glb") files.push_back(entry.path().string());
  }
  return files;
}

long peak_kib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST(InvalidCollection, EndsInAnErrorOrAWarning) {
  const fs::path folder = loom::test::scenes_folder() / "invalid-gltf";
  if (!fs::exists(folder)) GTEST_SKIP() << "absent: $LOOM_SCENES/invalid-gltf";
  std::map<std::string, int> errors_by_file;
  std::ifstream manifest(folder / "MANIFEST.json");
  for (const auto& entry : nlohmann::json::parse(manifest)) {
    errors_by_file[(folder / entry.at("file").get<std::string>()).string()] =
        entry.contains("errors") ? entry["errors"].get<int>() : entry.at("validator_run").value("errors", 0);
  }
  const std::vector<std::string> files = files_below(folder);
  EXPECT_EQ(files.size(), 217u);
  const long before = peak_kib();
  for (const std::string& file : files) {
    const Outcome outcome = load(file);
    if (errors_by_file[file] > 0) {
      EXPECT_GT(outcome.complaints, 0u) << file;
    } else {
      // Valid edge cases load, or are refused for something that is named.
      EXPECT_TRUE(!outcome.refused || !outcome.text.empty()) << file;
    }
  }
  // The largest file of the collection has under 1 MiB. Sanitizers keep what was freed, hence the room.
  EXPECT_LT(peak_kib() - before, 600 * 1024);
}

/// Every shipped feature file with single bytes changed: nothing may crash; the sanitizers watch.
TEST(Hostile, DamagedBytes) {
  const fs::path folder = loom::test::scenes_folder() / "gltf-features";
  if (!fs::exists(folder)) GTEST_SKIP() << "absent: $LOOM_SCENES/gltf-features";
  const TempDir temp;
  std::uint32_t random = 1;
  for (const char* name :
       {"BoxMeshopt/BoxMeshopt.glb", "BoxInterleaved/BoxInterleaved.glb", "box_sparse/box_sparse.glb",
        "BoxTextured-Binary/BoxTextured.glb", "gltf_primitives/gltf_primitives.glb"}) {
    std::ifstream file(folder / name, std::ios::binary);
    const std::string original((std::istreambuf_iterator<char>(file)), {});
    ASSERT_FALSE(original.empty()) << name;
    for (int round = 0; round < 60; ++round) {
      std::string damaged = original;
      for (int change = 0; change < 3; ++change) {
        random = random * 1664525u + 1013904223u;
        damaged[(random >> 8) % damaged.size()] = static_cast<char>(random >> 24);
      }
      const Outcome outcome = load(temp.write("damaged.glb", damaged));
      EXPECT_TRUE(!outcome.refused || !outcome.text.empty());
    }
    for (std::size_t length = 0; length < original.size(); length += 1 + original.size() / 50) {
      EXPECT_TRUE(load(temp.write("short.glb", original.substr(0, length))).refused) << name << " cut to " << length;
    }
  }
}

std::string with_accessor(const std::string& accessor, const std::string& more = "") {
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[)" +
         accessor + R"(],"bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}])" +
         more + "}";
}

TEST(Hostile, NamesTheFileThePlaceAndTheMistake) {
  const TempDir temp;
  const struct {
    std::string text, expected;
  } cases[] = {
      {with_accessor(R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})"),
       "/accessors/0: needs 48 bytes"},
      {with_accessor(R"({"bufferView":7,"componentType":5126,"count":3,"type":"VEC3"})"),
       "/accessors/0/bufferView: is 7, but there are 1 bufferViews"},
      {with_accessor(R"({"bufferView":0,"componentType":5126,"count":1e30,"type":"VEC3"})"), "/accessors/0/count"},
      {with_accessor(R"({"bufferView":0,"componentType":5126,"count":-1,"type":"VEC3"})"), "/accessors/0/count"},
      {with_accessor(R"({"bufferView":0,"componentType":5126,"count":2.5,"type":"VEC3"})"), "must be an integer"},
      {with_accessor(R"({"bufferView":0,"byteOffset":4294967295,"componentType":5126,"count":3,"type":"VEC3"})"),
       "/accessors/0: needs"},
      // Four thousand million zeros would be 48 GiB, for a file of a few hundred bytes.
      {with_accessor(R"({"componentType":5126,"count":4000000000,"type":"VEC3"})"),
       "has 4000000000 elements, but no data"},
      {with_accessor(R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})",
                     R"(,"extensionsRequired":["KHR_made_up"])"),
       "KHR_made_up"},
      {R"({"asset":{"version":"1.0"}})", "only glTF 2 is read"},
      {R"({"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[0]}],"scenes":[{"nodes":[0]}]})",
       "own ancestor"},
      {R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"../secret.bin"}]})",
       "does not stay within the folder"},
      {R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"%2e%2e/secret.bin"}]})",
       "does not stay within the folder"},
      {R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"/etc/passwd"}]})",
       "does not stay within the folder"},
      {R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"http://example.org/a.bin"}]})",
       "does not stay within the folder"},
      {R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"absent.bin"}]})", "does not exist"},
      {"{\n  \"asset\": {,}\n}", "bad.gltf:2:"},
      {"", "is empty"},
  };
  for (const auto& c : cases) {
    const Outcome outcome = load(temp.write("bad.gltf", c.text));
    EXPECT_TRUE(outcome.refused) << c.text;
    EXPECT_THAT(outcome.text, HasSubstr("bad.gltf:"));
    EXPECT_THAT(outcome.text, HasSubstr(c.expected)) << c.text;
  }
}

TEST(Hostile, DeepNestingIsNoStackOverflow) {
  const TempDir temp;
  const std::string deep(1u << 20, '[');
  EXPECT_TRUE(load(temp.write("deep.gltf", R"({"asset":{"version":"2.0","extras":)" + deep)).refused);
  const std::string closed = deep + std::string(deep.size(), ']');
  EXPECT_FALSE(load(temp.write("closed.gltf", R"({"asset":{"version":"2.0","extras":)" + closed + "}}")).refused);
}

TEST(Hostile, AManyTimesNamedAccessorHasALimit) {
  const TempDir temp;
  // Two hundred kilobytes that ask for 262 million vertices.
  std::string primitives;
  for (int i = 0; i < 4000; ++i) primitives += std::string(i == 0 ? "" : ",") + R"({"attributes":{"POSITION":0}})";
  const std::string padding(60000, ' ');
  const std::string text =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)" +
      primitives + R"(]}],"accessors":[{"componentType":5126,"count":65536,"type":"VEC3"}]})" + padding;
  const Outcome outcome = load(temp.write("many.gltf", text));
  EXPECT_TRUE(outcome.refused);
  EXPECT_THAT(outcome.text, HasSubstr("vertices, indices and keys"));
}

}  // namespace
