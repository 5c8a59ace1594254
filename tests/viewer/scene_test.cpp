// What is drawn into the scene: cells as bodies, handles of lights. And what comes from outside: reports, RenderDoc.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "loom/diagnostic.h"
#include "measure/sweep/result.h"
#include "scene/gpu_scene.h"
#include "support/temp_dir.h"
#include "viewer/light_gizmo.h"
#include "viewer/renderdoc.h"
#include "viewer/report_points.h"
#include "viewer/volume_cells.h"

namespace loom::test {
namespace {

using namespace viewer;

constexpr std::uint32_t magenta = 0xffff00ffu;

/// n³ cells of 0.5 m from (1, 2, 3), `parts` slabs.
VolumeSource volume(int n, int parts = 1) {
  interop::Grid grid{};
  grid.cells = {n, n, n, 1};
  grid.cascade[0] = {1, 2, 3, .5F};
  VolumeSource source;
  source.grid = grid;
  source.texels.desc = TextureDesc::volume(n, Format::rgba32f);
  source.texels.desc.depth = n * parts;
  source.texels.box = level_box(source.texels.desc, 0);
  source.texels.values.assign(static_cast<std::size_t>(n * n * n * parts), glm::vec4(0));
  return source;
}

glm::vec4& cell(VolumeSource& source, int x, int y, int z) {
  const int n = source.texels.desc.width;
  return source.texels.values[static_cast<std::size_t>((z * n + y) * n + x)];
}

TEST(VolumeCells, FilledCellsAreCubesAtTheirPlace) {
  VolumeSource source = volume(4);
  cell(source, 1, 2, 3) = {0, 1, 0, 1};
  const CellMesh mesh = make_cells(source, {.on = true, .size = 1}, {.encode = false});
  ASSERT_EQ(mesh.bodies.size(), 1u);
  EXPECT_EQ(mesh.bodies[0].cell, glm::ivec3(1, 2, 3));
  glm::vec3 low(1e9F), high(-1e9F);
  for (const CellVertex& v : mesh.vertices) {
    low = glm::min(low, v.position), high = glm::max(high, v.position);
    EXPECT_EQ(v.rgba & 0xff00ffu, 0u) << "green alone";
  }
  EXPECT_NEAR(glm::distance(low, glm::vec3(1.5, 3, 4.5)), 0, 1e-5);
  EXPECT_NEAR(glm::distance(high, glm::vec3(2, 3.5, 5)), 0, 1e-5);
}

TEST(VolumeCells, PartsAndSlicesAreChosen) {
  VolumeSource source = volume(4, 3);
  cell(source, 0, 0, 0) = cell(source, 1, 1, 2 * 4 + 1) = cell(source, 3, 2, 2 * 4 + 2) = glm::vec4(1);
  EXPECT_EQ(part_count(source), 3);
  EXPECT_EQ(make_cells(source, {.part = 0}, {}).bodies.size(), 1u);
  EXPECT_EQ(make_cells(source, {.part = 1}, {}).bodies.size(), 0u);
  EXPECT_EQ(make_cells(source, {.part = 2}, {}).bodies.size(), 2u);
  EXPECT_EQ(make_cells(source, {.part = 99}, {}).bodies.size(), 2u) << "the last";
  const CellMesh z = make_cells(source, {.part = 2, .one_slice = true}, {.slice = 2 * 4 + 2, .axis = 2});
  ASSERT_EQ(z.bodies.size(), 1u) << "a slice along z counts through all parts";
  EXPECT_EQ(z.bodies[0].cell, glm::ivec3(3, 2, 2));
  EXPECT_EQ(make_cells(source, {.part = 2, .one_slice = true}, {.slice = 1, .axis = 0}).bodies.size(), 1u);
}

TEST(VolumeCells, TooManyAreThinnedOut) {
  VolumeSource source = volume(32);
  source.texels.values.assign(source.texels.values.size(), glm::vec4(1));
  const CellMesh mesh = make_cells(source, {.on = true}, {});
  EXPECT_EQ(mesh.cells, 32768u);
  EXPECT_EQ(mesh.every, 2);
  EXPECT_EQ(mesh.bodies.size(), 4096u);
  const CellMesh slice = make_cells(source, {.on = true, .one_slice = true}, {.slice = 7, .axis = 1});
  EXPECT_EQ(slice.bodies.size(), 1024u) << "a slice has room for all";
}

TEST(VolumeCells, ALobeReachesWhereItsFunctionIsLarge) {
  VolumeSource source = volume(1);
  source.content = CellContent::harmonics;
  const float y0 = .28209479F, y1 = .48860251F;
  // f(ω) = 1 + x/2 in every direction: 1.5 towards +x, .5 towards −x.
  cell(source, 0, 0, 0) = {1 / y0, 0, 0, .5F / y1};
  const CellMesh mesh = make_cells(source, {.size = 1}, {});
  const glm::vec3 centre(1.25, 2.25, 3.25);
  float right = 0, left = 0;
  for (const CellVertex& v : mesh.vertices) {
    EXPECT_NE(v.rgba, magenta);
    right = std::max(right, v.position.x - centre.x), left = std::max(left, centre.x - v.position.x);
  }
  EXPECT_GT(right, 2 * left);
  EXPECT_LE(right, .2501F) << "it stays in its cell";
  cell(source, 0, 0, 0) = {.1F, 0, 0, 1};
  int negative = 0;
  for (const CellVertex& v : make_cells(source, {.size = 1}, {}).vertices) negative += v.rgba == magenta ? 1 : 0;
  EXPECT_GT(negative, 0);
  cell(source, 0, 0, 0) = glm::vec4(std::numeric_limits<float>::quiet_NaN());
  for (const CellVertex& v : make_cells(source, {.size = 1}, {}).vertices) {
    EXPECT_EQ(v.rgba, magenta);
    EXPECT_TRUE(std::isfinite(v.position.x));
  }
}

TEST(VolumeCells, AProbeShowsWhatArrivesFromEachDirection) {
  interop::ProbeGrid grid{};
  grid.counts = {2, 1, 1, 4};
  grid.lower = {0, 0, 0, 0};
  grid.spacing = {2, 2, 2, 0};
  VolumeSource source;
  source.grid = grid;
  source.content = CellContent::coefficients;
  source.states = {{0, 0, 0, 1}, {0, .5, 0, 1}};
  source.texels.desc = TextureDesc::layers({8, 1}, 1, Format::rgba32f);
  source.texels.box = level_box(source.texels.desc, 0);
  source.texels.values.assign(8, glm::vec4(0));
  // Probe 1: L = (1 + y)/2 in red.
  source.texels.values[4] = glm::vec4(.5F / .28209479F, 0, 0, 0);
  source.texels.values[5] = glm::vec4(.5F / .48860251F, 0, 0, 0);
  const CellMesh mesh = make_cells(source, {.size = 1}, {.encode = false, .flag = Flag::not_finite});
  ASSERT_EQ(mesh.bodies.size(), 1u) << "probe 0 holds nothing";
  const glm::vec3 centre(2, .5, 0);
  EXPECT_EQ(mesh.bodies[0].centre, centre) << "moved by its offset";
  for (const CellVertex& v : mesh.vertices) {
    const float y = (v.position.y - centre.y) / mesh.bodies[0].radius;
    EXPECT_NEAR(static_cast<float>(v.rgba & 255u) / 255, .5F * (1 + y), .01);
  }
}

TEST(VolumeCells, HarmonicsAreOrthonormal) {
  const double a = 1 / std::sqrt(3.);
  const glm::dvec3 w(a, a, a);
  EXPECT_NEAR(spherical_harmonic(0, w), .282094792, 1e-8);
  EXPECT_NEAR(spherical_harmonic(1, {0, 1, 0}), .488602512, 1e-8);
  EXPECT_NEAR(spherical_harmonic(2, {0, 0, 1}), .488602512, 1e-8);
  EXPECT_NEAR(spherical_harmonic(3, {1, 0, 0}), .488602512, 1e-8);
  EXPECT_NEAR(spherical_harmonic(4, w), 1.092548431 / 3, 1e-8);
  EXPECT_NEAR(spherical_harmonic(8, {1, 0, 0}), .546274215, 1e-8);
  // Σ_m Y_lm² = (2l+1)/4π.
  double sum = 0;
  for (int i = 16; i < 25; ++i) sum += spherical_harmonic(i, w) * spherical_harmonic(i, w);
  EXPECT_NEAR(sum, 9 / (4 * std::numbers::pi), 1e-8);
}

TEST(VolumeCells, ARayMeetsTheNearestBody) {
  VolumeSource source = volume(4);
  cell(source, 0, 0, 0) = cell(source, 0, 0, 3) = glm::vec4(1);
  const CellMesh mesh = make_cells(source, {.size = 1}, {});
  const int hit = hit_body(mesh, {1.25, 2.25, 9}, {0, 0, -1});
  ASSERT_GE(hit, 0);
  EXPECT_EQ(mesh.bodies[static_cast<std::size_t>(hit)].cell.z, 3);
  EXPECT_EQ(hit_body(mesh, {9, 9, 9}, {0, 0, 1}), -1);
}

/// A camera 4 m in front of the origin, 200×100 pixels at (10, 20).
ScreenView front_view() {
  scene::Box box;
  box.add(glm::dvec3(-1)), box.add(glm::dvec3(1));
  const scene::Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}};
  return {.camera = scene::make_camera(camera, box, {200, 100}), .corner = {10, 20}, .size = {200, 100}};
}

scene::Box unit_box() {
  scene::Box box;
  box.add(glm::dvec3(-1)), box.add(glm::dvec3(1));
  return box;
}

glm::vec2 place_of(const std::vector<Handle>& handles, HandleKind kind) {
  for (const Handle& handle : handles)
    if (handle.kind == kind) return handle.at;
  return {-1, -1};
}

TEST(LightGizmo, FollowsThePointer) {
  const ScreenView view = front_view();
  const scene::Light light{.kind = scene::LightKind::spot, .position = {.2, .3, -.1}, .direction = {0, -1, 0}};
  const auto handles = handles_of(view, light, unit_box());
  EXPECT_EQ(handles.size(), 5u);
  for (const HandleKind kind : {HandleKind::centre, HandleKind::axis_x, HandleKind::axis_y}) {
    const glm::vec2 way(kind == HandleKind::axis_y ? 0 : 12, kind == HandleKind::axis_x ? 0 : -7);
    const glm::vec2 from = place_of(handles, kind), to = from + way;
    const auto moved = dragged_light(view, light, unit_box(), kind, from, to);
    ASSERT_TRUE(moved);
    const glm::vec2 centre = *on_screen(view, light.position), now = *on_screen(view, moved->position);
    EXPECT_NEAR(now.x - centre.x, way.x, .1);
    EXPECT_NEAR(now.y - centre.y, way.y, .1);
    EXPECT_NEAR(moved->position.z, light.position.z, 1e-9);
    EXPECT_EQ(moved->direction, light.direction);
  }
  const auto x = dragged_light(view, light, unit_box(), HandleKind::axis_x, {60, 60}, {80, 90});
  EXPECT_EQ(x->position.y, light.position.y) << "along its axis alone";
}

TEST(LightGizmo, TurnsALight) {
  const ScreenView view = front_view();
  const scene::Light light{.kind = scene::LightKind::directional, .direction = {0, -1, 0}};
  const auto handles = handles_of(view, light, unit_box());
  EXPECT_EQ(handles.size(), 2u) << "it has no place to be moved from";
  const glm::vec2 from = place_of(handles, HandleKind::direction), centre = place_of(handles, HandleKind::centre);
  EXPECT_GT(from.y, centre.y) << "downwards";
  EXPECT_FALSE(dragged_light(view, light, unit_box(), HandleKind::centre, centre, centre + glm::vec2(9, 9)));
  const glm::vec2 right(centre.x + (from.y - centre.y), centre.y);
  const auto turned = dragged_light(view, light, unit_box(), HandleKind::direction, from, right);
  ASSERT_TRUE(turned);
  EXPECT_NEAR(glm::length(turned->direction), 1, 1e-9);
  EXPECT_GT(turned->direction.x, .9);
}

TEST(LightGizmo, WhatIsBehindTheCameraHasNoHandles) {
  const ScreenView view = front_view();
  EXPECT_TRUE(handles_of(view, {.position = {0, 0, 9}}, unit_box()).empty());
  EXPECT_TRUE(handles_of(view, {.position = glm::dvec3(std::numeric_limits<double>::quiet_NaN())}, unit_box()).empty());
}

TEST(ReportPoints, AreThoseThatWereMeasured) {
  const TempDir dir;
  nlohmann::ordered_json report = {{"points", nlohmann::ordered_json::array()}};
  const auto add = [&](const std::string& pipeline, double ms, double relmse, const std::string& failure = {}) {
    measure::Result r{.key = pipeline, .scene = "cornell-box", .pipeline = pipeline, .size = {64, 64}, .samples = 4};
    r.set.emplace_back("lpv.iterations", "8");
    r.failure = failure;
    r.gpu_ms = {ms, ms};
    r.errors["hdr"] = {.relmse = relmse};
    report["points"].push_back(measure::to_json(r));
  };
  add("fast", 1, .5);
  add("good", 4, .1);
  add("worse", 5, .2);
  add("broken", 1, .01, "it broke");
  const std::string file = dir.write("report.json", report.dump());
  EXPECT_EQ(report_file(dir.path()), file) << "a folder means the report in it";
  const Report loaded = load_report(file);
  ASSERT_EQ(loaded.points.size(), 3u);
  EXPECT_THAT(loaded.scenes, testing::ElementsAre("cornell-box"));
  EXPECT_EQ(loaded.points[0].label, "fast lpv.iterations=8");
  EXPECT_TRUE(loaded.points[0].front && loaded.points[1].front);
  EXPECT_FALSE(loaded.points[2].front);
  for (const char* bad : {"", "{", "[]", "{}", R"({"points": 3})", R"({"points": [{}]})", R"({"points": []})"}) {
    dir.write("report.json", bad);
    EXPECT_THROW(load_report(file), Error) << bad;
  }
  EXPECT_THROW(load_report("/nowhere/report.json"), Error);
}

TEST(RenderDoc, CapturesWhatIsDrawnWhereItIsAttached) {
  ASSERT_FALSE(renderdoc_attached());
  EXPECT_THROW(renderdoc_capture([] {}), Error);
  // RenderDoc puts its library into the process before anything else runs; this one does as it does.
  void* library = dlopen(FAKE_RENDERDOC, RTLD_NOW);
  ASSERT_NE(library, nullptr) << dlerror();
  EXPECT_TRUE(renderdoc_attached());
  const auto capturing = reinterpret_cast<int (*)()>(dlsym(library, "fake_is_capturing"));
  ASSERT_NE(capturing, nullptr);
  bool drawn = false;
  const std::string path = renderdoc_capture([&] { drawn = capturing() == 1; });
  EXPECT_TRUE(drawn);
  EXPECT_EQ(path, "fake-1.rdc");
  EXPECT_THROW(renderdoc_capture([] { throw Error("no"); }), Error);
  EXPECT_EQ(capturing(), 0) << "a capture that failed has ended";
  dlclose(library);
}

}  // namespace
}  // namespace loom::test
