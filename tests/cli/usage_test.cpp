// Help, bad usage, and what every command does with what it cannot read.
#include <string>
#include <vector>

#include "cli/cli.h"

namespace loom::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Usage = Cli;

TEST_F(Usage, HelpNamesEveryOptionOfTheContract) {
  const ProcessResult all = expect(0, {"--help"});
  for (const char* command :
       {"render", "reference", "compare", "check", "plan", "graph", "passes", "info", "new-pass"}) {
    EXPECT_THAT(all.out, HasSubstr(std::string("\n  ") + command)) << command;
    const ProcessResult help = expect(0, {command, "--help"});
    EXPECT_THAT(help.out, HasSubstr("--plugins")) << command;
    EXPECT_THAT(help.err, IsEmpty());
  }
  const std::string render = expect(0, {"render", "--help"}).out;
  for (const char* option : {"-p", "-o", "--size", "--samples", "--frames", "--dt", "--seed", "--set", "--camera",
                             "--output", "--stats", "--no-prune", "--no-alias", "--check-finite", "--max-memory"}) {
    EXPECT_THAT(render, HasSubstr(option));
  }
  EXPECT_THAT(expect(0, {"--version"}).out, HasSubstr("loom "));
}

TEST_F(Usage, BadUsageIsTwoAndSaysWhereHelpIs) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"paint"},
                                             {"render"},
                                             {"render", "--colour", "red", "-o", "x.png"},
                                             {"render", "-o", "x.png", "-p", "direct", "--samples", "0"},
                                             {"render", "-o", "x.png", "-p", "direct", "--samples", "two"},
                                             {"render", "-o", "x.png", "-p", "direct", "--frames", "-1"},
                                             {"render", "-o", "x.png", "-p", "direct", "--dt", "-1"},
                                             {"render", "-o", "x.png", "-p", "direct", "--max-memory", "lots"},
                                             {"check"},
                                             {"graph", "direct", "--format", "png"},
                                             {"new-pass"}}) {
    const ProcessResult result = expect(2, arguments);
    EXPECT_THAT(result.err, HasSubstr("error[usage]"));
    EXPECT_THAT(result.err, HasSubstr("--help"));
    EXPECT_THAT(result.out, IsEmpty());
  }
}

TEST_F(Usage, BadValuesAreNamedWithWhatToDo) {
  struct Case {
    std::vector<std::string> options;
    std::string said;
  };
  for (const Case& c : std::vector<Case>{{{"--set", "exposure"}, "pass.param=value"},
                                         {{"--set", "=1"}, "pass.param=value"},
                                         {{"--set", ".a=1"}, "pass.param=value"},
                                         {{"--no-prune=unred"}, "did you mean unread?"},
                                         {{"--set", "tonemap.exposre=1"}, "exposure"},
                                         {{"--set", "tonemap.exposure=much"}, "exposure"},
                                         {{"--set", "tonmap.exposure=1"}, "tonemap"},
                                         {{"--output", "gbuffer.surface.albdo"}, "albedo"},
                                         {{"--output", "picture"}, "picture"},
                                         {{"--camera", "no such camera"}, "no such camera"},
                                         {{"--camera", "{\"eye\": 3}"}, "eye"},
                                         {{"--plugins", "no-such-folder"}, "no-such-folder"},
                                         {{"--stats", "no-such-folder/s.json"}, "no-such-folder"}}) {
    const ProcessResult result = expect(2, render("direct", path("x.png"), c.options));
    EXPECT_THAT(result.err, HasSubstr(c.said)) << testing::PrintToString(c.options);
    EXPECT_THAT(files(), IsEmpty());
  }
}

TEST_F(Usage, SizesAreTwoNumbers) {
  for (const char* size : {"32", "0x10", "10x", "x10", "99999999x4", "3.5x4", "10x10x10", "-4x4", ""}) {
    const ProcessResult result =
        expect(2, {"render", "-p", "direct", "-o", path("x.png"), std::string("--size=") + size});
    EXPECT_THAT(result.err, HasSubstr("error[usage]")) << size;
    EXPECT_THAT(files(), IsEmpty());
  }
}

TEST_F(Usage, PicturesGoToFilesThatCanBe) {
  for (const char* out :
       {"x.jpg", "x", "no/such/folder/x.png", "a%sb.png", "a%d_%d.png", "a%0d.png", "a%.png", "a%4d.png"}) {
    const ProcessResult result = expect(2, render("direct", path(out)));
    EXPECT_THAT(result.err, HasSubstr("-o ")) << out;
    EXPECT_THAT(files(), IsEmpty()) << out;
  }
}

TEST_F(Usage, NamesNearAShippedOneAreSuggested) {
  EXPECT_THAT(expect(2, render("drect", path("x.png"))).err, HasSubstr("did you mean direct?"));
  EXPECT_THAT(expect(2, {"info", "cornell-bux"}).err, HasSubstr("did you mean cornell-box?"));
  EXPECT_THAT(expect(2, {"passes", "Tonmap"}).err, HasSubstr("did you mean Tonemap?"));
  const ProcessResult none = expect(2, {"render", "-o", path("x.png")});
  EXPECT_THAT(none.err, HasSubstr("-p PIPELINE"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Usage, FailuresUnderJsonAreJson) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{render("nothing", path("x.png"), {"--json"}),
                                             render("direct", path("x.png"), {"--json", "--size", "x"}),
                                             {"render", "--json"},
                                             {"check", "--json", "nothing"},
                                             {"plan", "-p", "nothing", "--json"},
                                             {"info", "nothing", "--json"},
                                             {"passes", "Nothing", "--json"}}) {
    const ProcessResult result = expect(2, arguments);
    const Json document = Json::parse(result.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << result.out;
    EXPECT_EQ(document.at("version"), 1);
    ASSERT_EQ(document.at("diagnostics").size(), 1u);
    EXPECT_THAT(keys(document.at("diagnostics")[0]),
                ElementsAre("severity", "code", "message", "file", "line", "column", "pointer", "hint"));
    EXPECT_EQ(document.at("diagnostics")[0].at("severity"), "error");
    EXPECT_THAT(result.err, Not(IsEmpty()));
  }
}

TEST_F(Usage, DamagedScenesLeaveNothing) {
  const std::string empty = dir_.write("empty.gltf", "");
  const std::string text = dir_.write("text.glb", "hello");
  const std::string key = dir_.write("key.json", R"({"scenes": "x.glb"})");
  const std::vector<std::string> before = files();
  for (const std::string& scene : {empty, text, key, path("missing.gltf")}) {
    expect(2, {"render", scene, "-p", "direct", "-o", path("x.png")});
    expect(2, {"info", scene});
    EXPECT_EQ(files(), before);
  }
}

}  // namespace
}  // namespace loom::test
