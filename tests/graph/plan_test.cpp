// What the compiler makes of small pipelines: order, culling, resources, aliasing, barriers.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/fakes.h"

namespace loom::test {
namespace {

using graph::CompiledGraph;
using graph::CompileOptions;
using graph::CompileResult;
using Lifetime = graph::Resource::Lifetime;

const Registry& types() {
  static const Registry registry = fake_registry();
  return registry;
}

CompiledGraph compiled(const std::string& text, const CompileOptions& options = {},
                       const SceneFacts& facts = one_light()) {
  CompileResult result = compile(text, types(), options, facts);
  if (!result.graph) {
    ADD_FAILURE() << text_of(result.diagnostics);
    return {};
  }
  return std::move(*result.graph);
}

const graph::BoundPort& port(const CompiledGraph& graph, std::string_view pass, std::string_view name) {
  for (const auto& candidate : graph.pass(pass)->bound)
    if (candidate.name == name) return candidate;
  ADD_FAILURE() << pass << " has no port " << name;
  return graph.passes[0].bound[0];
}

std::string why_pruned(const CompiledGraph& graph, std::string_view what) {
  for (const auto& pruned : graph.pruned)
    if (pruned.what == what) return pruned.why;
  return "kept";
}

constexpr const char* lit = R"({
  "passes": {
    "show": { "type": "Show", "in": { "light": "shade.irradiance" } },
    "shade": { "type": "Shade", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } },
    "rsm": { "type": "Lights" },
    "gbuffer": { "type": "Geometry" },
    "unused": { "type": "Filter", "in": { "image": "show.image" } },
    "unused2": { "type": "Filter", "in": { "image": "unused.image" } }
  },
  "outputs": { "image": "show.image", "indirect": null }
})";

TEST(Plan, ProducersRunBeforeConsumersAndOtherwiseInFileOrder) {
  EXPECT_EQ(order_of(compiled(lit)), "rsm gbuffer shade show");
}

TEST(Plan, LeavesOutWhatNobodyReadsAndSaysWhy) {
  const auto graph = compiled(lit);
  EXPECT_EQ(why_pruned(graph, "unused2"), "nothing reads it");
  EXPECT_EQ(why_pruned(graph, "unused"), "read by `unused2` alone, which does not run");
  EXPECT_EQ(why_pruned(graph, "gbuffer.surface.albedo"), "nothing reads it");
  EXPECT_TRUE(has_resource(graph, "gbuffer.surface.depth"));
  EXPECT_FALSE(has_resource(graph, "gbuffer.surface.albedo"));
  EXPECT_FALSE(graph.pass("unused")->runs);
  const auto& surface = port(graph, "gbuffer", "surface");
  ASSERT_EQ(surface.members.size(), 3U);
  EXPECT_EQ(surface.members[2].name, "albedo");
  EXPECT_EQ(surface.members[2].resource, graph::none);
}

TEST(Plan, RecordsDecisionsOfPassesAndOfCulling) {
  const auto graph = compiled(lit);
  const auto has = [&](const std::string& rule, const std::string& decision) {
    return std::any_of(graph.decisions.begin(), graph.decisions.end(),
                       [&](const Decision& d) { return d.rule == rule && d.decision == decision; });
  };
  EXPECT_TRUE(has("no-emission", "`emission` is not made"));
  EXPECT_TRUE(has("unread", "`unused2` left out"));
}

TEST(Plan, WithoutPruningEverythingRunsAndIsMade) {
  const auto graph = compiled(lit, {.prune = false});
  EXPECT_EQ(order_of(graph), "rsm gbuffer shade show unused unused2");
  EXPECT_TRUE(has_resource(graph, "gbuffer.surface.albedo"));
  EXPECT_TRUE(has_resource(graph, "gbuffer.surface.emission")) << "rule no-emission is off too";
  EXPECT_TRUE(graph.pruned.empty());
}

TEST(Plan, OneRuleCanBeDisabledAlone) {
  const auto graph = compiled(lit, {.disabled_rules = {"no-emission"}, .external_inputs = {}});
  EXPECT_EQ(order_of(graph), "rsm gbuffer shade show");
  EXPECT_EQ(why_pruned(graph, "gbuffer.surface.emission"), "nothing reads it");
  const auto unread = compiled(lit, {.disabled_rules = {"unread"}, .external_inputs = {}});
  EXPECT_EQ(order_of(unread), "rsm gbuffer shade show unused unused2");
}

TEST(Plan, AbsentBundlesPropagate) {
  const auto graph = compiled(R"({
    "passes": {
      "gbuffer": { "type": "Geometry" },
      "rsm": { "type": "Lights" },
      "shade": { "type": "Shade", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } }
    },
    "outputs": { "image": "shade.irradiance" } })",
                              {}, SceneFacts{});
  EXPECT_EQ(order_of(graph), "");
  EXPECT_EQ(why_pruned(graph, "rsm"), "`lights` carries nothing: the scene has no punctual light");
  EXPECT_EQ(why_pruned(graph, "gbuffer"), "read by `shade` alone, which does not run");
  ASSERT_EQ(graph.outputs.size(), 1U);
  EXPECT_EQ(graph.outputs[0].resource, graph::none);
  EXPECT_EQ(graph.outputs[0].absent, "no light: the scene has no punctual light");
}

TEST(Plan, NullOutputsAreAbsent) {
  const auto graph = compiled(lit);
  ASSERT_EQ(graph.outputs.size(), 2U);
  EXPECT_EQ(graph.outputs[1].name, "indirect");
  EXPECT_TRUE(graph.outputs[1].absent.has_value());
}

TEST(Plan, AMemberThatThisSceneDoesNotNeedIsAbsentAsAnOutput) {
  const auto graph = compiled(lit, {.requested = {"gbuffer.surface.emission"}});
  EXPECT_EQ(graph.outputs.at(0).resource, graph::none);
  EXPECT_EQ(graph.outputs.at(0).absent, "`gbuffer.surface` has no `emission` here");
}

TEST(Plan, ForwardedBundlesResolveToTheirSource) {
  const auto graph = compiled(R"({
    "passes": {
      "source": { "type": "Source" },
      "one": { "type": "Pass", "in": { "image": "source.image" } },
      "two": { "type": "Pass", "in": { "image": "one.image" } },
      "out": { "type": "Filter", "in": { "image": "two.image" } }
    },
    "outputs": { "image": "out.image", "hdr": "two.image" } })");
  EXPECT_EQ(order_of(graph), "source out");
  EXPECT_EQ(why_pruned(graph, "two"), "`image` is `image` unchanged");
  const auto source = port(graph, "source", "image").members[0].resource;
  EXPECT_EQ(port(graph, "out", "image").members[0].resource, source);
  EXPECT_EQ(port(graph, "out", "image").bundle, port(graph, "source", "image").bundle);
  EXPECT_EQ(graph.outputs[1].resource, source);
  EXPECT_EQ(graph.outputs[1].quantity, "radiance");
  EXPECT_EQ(graph.outputs[0].quantity, "image");
}

TEST(Plan, InPlaceWritersRunAfterReadersOfTheOldValue) {
  const auto graph = compiled(R"({
    "passes": {
      "source": { "type": "Source" },
      "brighten": { "type": "Brighten", "in": { "image": "source.image" } },
      "before": { "type": "Filter", "in": { "image": "source.image" } },
      "after": { "type": "Filter", "in": { "image": "brighten.image" } },
      "mix": { "type": "Mix", "in": { "a": "before.image", "b": "after.image" } }
    },
    "outputs": { "image": "mix.image" } })");
  EXPECT_EQ(order_of(graph), "source before brighten after mix");
  EXPECT_FALSE(has_resource(graph, "brighten.image.image"));
  EXPECT_EQ(port(graph, "after", "image").members[0].resource, port(graph, "source", "image").members[0].resource);
  EXPECT_EQ(resource(graph, "source.image.image").last, 3);
  for (const auto& bound : graph.pass("brighten")->bound) EXPECT_EQ(bound.members[0].access, Access::image_read_write);
}

TEST(Plan, HistoryImposesNoOrderKeepsTheProducerAliveAndHasItsOwnStorage) {
  const auto graph = compiled(R"({
    "passes": {
      "early": { "type": "Accumulate", "in": { "image": "source.image", "last": "late.image@prev" } },
      "source": { "type": "Source" },
      "late": { "type": "Filter", "in": { "image": "early.image" } }
    },
    "outputs": { "image": "early.image" } })");
  EXPECT_EQ(order_of(graph), "source early late");
  const auto& previous = resource(graph, "late.image.image@prev");
  const auto& current = resource(graph, "late.image.image");
  EXPECT_EQ(&graph.resources[static_cast<std::size_t>(previous.history_of)], &current);
  EXPECT_EQ(previous.lifetime, Lifetime::history);
  EXPECT_EQ(current.lifetime, Lifetime::history);
  EXPECT_NE(previous.slot, current.slot);
  EXPECT_TRUE(port(graph, "early", "last").history);
  EXPECT_TRUE(graph.bundles[static_cast<std::size_t>(port(graph, "early", "last").bundle)].history);
  EXPECT_EQ(resource(graph, "early.persistent.count").lifetime, Lifetime::persistent);
}

TEST(Plan, APassMayReadItsOwnLastFrame) {
  const auto graph = compiled(R"({
    "passes": {
      "source": { "type": "Source" },
      "taa": { "type": "Accumulate", "in": { "image": "source.image", "last": "taa.image@prev" } }
    },
    "outputs": { "image": "taa.image" } })");
  EXPECT_EQ(resource(graph, "taa.image.image@prev").clear, glm::vec4(0.5F));
  EXPECT_EQ(resource(graph, "taa.image.image").lifetime, Lifetime::history);
  EXPECT_EQ(graph.resources[static_cast<std::size_t>(graph.outputs[0].resource)].name, "taa.image.image");
}

TEST(Plan, OptionalInputsMayStayUnwired) {
  const auto graph = compiled(R"({
    "passes": {
      "volume": { "type": "Volume" },
      "debug": { "type": "Debug", "in": { "any": "volume.volume" } }
    },
    "outputs": { "image": "debug.image" } })");
  EXPECT_FALSE(port(graph, "volume", "previous").connected);
  EXPECT_EQ(port(graph, "debug", "any").type, "ShVolume");
  EXPECT_TRUE(has_resource(graph, "volume.volume.green")) << "read by reads_all()";
  EXPECT_TRUE(resource(graph, "volume.volume.red").clear_each_frame);
  EXPECT_EQ(graph.pass("debug")->barriers, unsigned{graph::barrier_texture_fetch});
}

std::string chain(int length) {
  std::string text = R"({ "passes": { "p0": { "type": "Source" })";
  for (int i = 1; i <= length; ++i)
    text += ", \"p" + std::to_string(i) + R"(": { "type": "Filter", "in": { "image": "p)" + std::to_string(i - 1) +
            R"(.image" } })";
  return text + R"( }, "outputs": { "image": "p)" + std::to_string(length) + R"(.image" } })";
}

TEST(Plan, AChainNeedsTwoTransientsAndItsOutput) {
  const auto graph = compiled(chain(10));
  EXPECT_EQ(graph.slots.size(), 3U);
  EXPECT_EQ(graph.bytes_without_aliasing, 11U * 512 * 512 * 8);
  EXPECT_EQ(graph.bytes, 3U * 512 * 512 * 8);
  EXPECT_EQ(resource(graph, "p10.image.image").lifetime, Lifetime::output);
}

TEST(Plan, WithoutAliasingEveryResourceHasItsOwnSlot) {
  const auto graph = compiled(chain(10), {.alias = false});
  EXPECT_EQ(graph.slots.size(), 11U);
  EXPECT_EQ(graph.bytes, graph.bytes_without_aliasing);
}

TEST(Plan, VolumesShareStorageToo) {
  const auto graph = compiled(R"({
    "passes": {
      "a": { "type": "Volume" },
      "b": { "type": "Volume", "in": { "previous": "a.volume" } },
      "c": { "type": "Volume", "in": { "previous": "b.volume" } },
      "debug": { "type": "Debug", "in": { "any": "c.volume" } }
    },
    "outputs": { "image": "debug.image" } })");
  EXPECT_EQ(resource(graph, "a.volume.red").slot, resource(graph, "c.volume.red").slot);
  EXPECT_NE(resource(graph, "a.volume.red").slot, resource(graph, "b.volume.red").slot);
  EXPECT_LT(graph.bytes, graph.bytes_without_aliasing);
}

TEST(Plan, KeptOutputsAreNeverShared) {
  const auto graph = compiled(lit);
  EXPECT_EQ(resource(graph, "rsm.lights.flux").lifetime, Lifetime::kept);
  EXPECT_TRUE(graph.pass("rsm")->ports.keeps_outputs);
}

TEST(Plan, BarriersNameTheAccessThatComesAfterAStore) {
  const auto graph = compiled(chain(3));
  // p1 stores for the first time into what p0 rendered, or into what an earlier frame fetched from.
  EXPECT_NE(graph.pass("p1")->barriers & graph::barrier_image_access, 0U);
  EXPECT_EQ(graph.pass("p2")->barriers & graph::barrier_texture_fetch, graph::barrier_texture_fetch);
  EXPECT_EQ(graph.pass("p3")->barriers & graph::barrier_texture_fetch, graph::barrier_texture_fetch);
}

TEST(Plan, RenderingAndFetchesNeedNoBarriers) {
  const auto graph = compiled(R"({
    "passes": {
      "gbuffer": { "type": "Geometry" },
      "debug": { "type": "Debug", "in": { "any": "gbuffer.surface" } }
    },
    "outputs": { "image": "debug.image" } })");
  for (const auto& pass : graph.passes) EXPECT_EQ(pass.barriers, 0U) << pass.name;
}

TEST(Plan, SideEffectsKeepAPassAlive) {
  const auto graph = compiled(R"({
    "passes": {
      "source": { "type": "Source" },
      "other": { "type": "Source" },
      "sink": { "type": "Sink", "in": { "image": "other.image" } }
    },
    "outputs": { "image": "source.image" } })");
  EXPECT_EQ(order_of(graph), "source other sink");
}

TEST(Plan, OnlyWhatIsAskedForIsMade) {
  const auto graph = compiled(lit, {.requested = {"gbuffer.surface.albedo"}});
  EXPECT_EQ(order_of(graph), "gbuffer");
  ASSERT_EQ(graph.outputs.size(), 1U);
  EXPECT_EQ(graph.outputs[0].quantity, "albedo");
  EXPECT_FALSE(has_resource(graph, "gbuffer.surface.depth"));
  EXPECT_EQ(order_of(compiled(lit, {.requested = {"gbuffer.surface"}})), "gbuffer") << "the primary member";
}

TEST(Plan, ExternalInputsAreBoundAndHaveNoSlot) {
  constexpr const char* text = R"({
    "inputs": { "env": { "type": "Image", "format": "rgba16f", "size": [64, 32] } },
    "passes": { "filter": { "type": "Filter", "in": { "image": "inputs.env" } } },
    "outputs": { "image": "filter.image" } })";
  const auto graph = compiled(text);
  const auto& env = resource(graph, "inputs.env.image");
  EXPECT_EQ(env.lifetime, Lifetime::external);
  EXPECT_EQ(env.slot, graph::none);
  EXPECT_EQ(std::get<TextureDesc>(env.desc).width, 64);
  EXPECT_EQ(graph.bytes_without_aliasing, 512U * 512 * 8);

  BundleInfo given{.type = "Image"};
  given.members.push_back({.name = "image", .desc = TextureDesc::image({8, 8}, Format::rgba16f)});
  const auto supplied = compiled(text, {.external_inputs = {{"env", given}}});
  EXPECT_EQ(std::get<TextureDesc>(resource(supplied, "inputs.env.image").desc).width, 8);
}

TEST(Plan, AnExternalInputOfAnotherTypeOrFormatIsRefused) {
  constexpr const char* text = R"({
    "inputs": { "env": { "type": "Image", "format": "rgba16f" } },
    "passes": { "filter": { "type": "Filter", "in": { "image": "inputs.env" } } },
    "outputs": { "image": "filter.image" } })";
  BundleInfo given{.type = "Image"};
  given.members.push_back({.name = "image", .desc = TextureDesc::image({8, 8}, Format::rgba8)});
  const auto result = compile(text, types(), {.external_inputs = {{"env", given}}});
  ASSERT_FALSE(result.graph.has_value());
  EXPECT_EQ(result.diagnostics.all()[0].code, "input-mismatch");
  EXPECT_THAT(result.diagnostics.all()[0].message, testing::HasSubstr("rgba8 8x8"));
}

TEST(Plan, OverridesSetParametersAndLaterOnesWin) {
  constexpr const char* text = R"({
    "passes": { "s": { "type": "Source" },
                "t": { "type": "Tuned", "in": { "image": "s.image" }, "params": { "iterations": 3, "radius": 0.5 } } },
    "outputs": { "image": "t.image" } })";
  const auto graph = compiled(text, {.overrides = {{"t", "iterations", "4"},
                                                   {"t", "iterations", "5"},
                                                   {"t", "basis", "sg"},
                                                   {"t", "label", "16"},
                                                   {"t", "tint", "[0, 0.5, 1]"}}});
  const auto value = [&](std::string_view name) { return Params::value_of(*graph.pass("t")->params.find(name)); };
  EXPECT_EQ(std::get<int>(value("iterations")), 5);
  EXPECT_EQ(std::get<float>(value("radius")), 0.5F);
  EXPECT_EQ(std::get<std::string>(value("basis")), "sg");
  EXPECT_EQ(std::get<std::string>(value("label")), "16");
  EXPECT_EQ(std::get<glm::vec3>(value("tint")), glm::vec3(0, 0.5F, 1));
}

TEST(Plan, OverridesThatNameNothingAreReportedWithTheNearestName) {
  const auto result = compile(chain(1), types(), {.overrides = {{"p9", "x", "1"}, {"p1", "x", "1"}}});
  ASSERT_FALSE(result.graph.has_value());
  EXPECT_THAT(text_of(result.diagnostics), testing::HasSubstr("--set p9.x=1: error[unknown-pass]"));
  EXPECT_THAT(text_of(result.diagnostics), testing::HasSubstr("did you mean `p0`?"));
  EXPECT_THAT(text_of(result.diagnostics), testing::HasSubstr("error[unknown-param]"));
}

TEST(Plan, CompilingTwiceGivesTheSamePlan) {
  const auto a = compiled(lit);
  const auto b = compiled(lit);
  ASSERT_EQ(a.resources.size(), b.resources.size());
  for (std::size_t i = 0; i < a.resources.size(); ++i) {
    EXPECT_EQ(a.resources[i].name, b.resources[i].name);
    EXPECT_EQ(a.resources[i].slot, b.resources[i].slot);
  }
}

}  // namespace
}  // namespace loom::test
