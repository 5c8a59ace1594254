#include "support/bench.h"

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "loom/diagnostic.h"
#include "loom/registry.h"
#include "plugins/loader.h"
#include "scene/load.h"

namespace loom::test {
namespace {

template <class T>
std::size_t at(T i) {
  return static_cast<std::size_t>(i);
}

scene::Light light_of(scene::LightKind kind, glm::vec3 intensity) {
  scene::Light light;
  light.kind = kind;
  light.intensity = intensity;
  return light;
}

}  // namespace

SceneBuilder::SceneBuilder() { scene_.path = "made by hand"; }

int SceneBuilder::material(glm::vec3 albedo, glm::vec3 emission, bool double_sided) {
  scene::Material made;
  made.base_color = glm::vec4(albedo, 1);
  made.emissive = emission;
  made.double_sided = double_sided;
  scene_.materials.push_back(made);
  return static_cast<int>(scene_.materials.size()) - 1;
}

SceneBuilder& SceneBuilder::triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, int material) {
  scene::Primitive primitive;
  primitive.positions = {a, b, c};
  primitive.normals.assign(3, glm::normalize(glm::cross(b - a, c - a)));
  primitive.indices = {0, 1, 2};
  primitive.material = material;
  scene::Node node;
  node.mesh = static_cast<int>(scene_.meshes.size());
  if (path_) {
    scene_.animations.front().channels.push_back({.node = static_cast<int>(scene_.nodes.size()),
                                                  .times = {0, 1},
                                                  .values = {glm::vec4(0), glm::vec4(*path_, 0)}});
  }
  scene_.instances.push_back({.mesh = node.mesh, .node = static_cast<int>(scene_.nodes.size())});
  scene_.nodes.push_back(node);
  scene_.meshes.push_back({.name = "", .primitives = {primitive}});
  return *this;
}

SceneBuilder& SceneBuilder::quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, int material) {
  return triangle(a, b, c, material).triangle(a, c, d, material);
}

SceneBuilder& SceneBuilder::floor(glm::vec3 centre, float half, int material) {
  return quad(centre + glm::vec3(-half, 0, half), centre + glm::vec3(half, 0, half), centre + glm::vec3(half, 0, -half),
              centre + glm::vec3(-half, 0, -half), material);
}

SceneBuilder& SceneBuilder::box(glm::vec3 l, glm::vec3 h, int m) {
  quad({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}, m);
  quad({h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z}, m);
  quad({h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}, m);
  quad({l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z}, m);
  quad({l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}, m);
  return quad({l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z}, m);
}

SceneBuilder& SceneBuilder::point(glm::vec3 position, glm::vec3 intensity) {
  scene::Light light = light_of(scene::LightKind::point, intensity);
  light.position = position;
  scene_.lights.push_back(light);
  return *this;
}

SceneBuilder& SceneBuilder::spot(glm::vec3 position, glm::vec3 direction, glm::vec3 intensity, double inner_rad,
                                 double outer_rad) {
  scene::Light light = light_of(scene::LightKind::spot, intensity);
  light.position = position;
  light.direction = glm::normalize(glm::dvec3(direction));
  light.inner_rad = inner_rad;
  light.outer_rad = outer_rad;
  scene_.lights.push_back(light);
  return *this;
}

SceneBuilder& SceneBuilder::directional(glm::vec3 direction, glm::vec3 irradiance) {
  scene::Light light = light_of(scene::LightKind::directional, irradiance);
  light.direction = glm::normalize(glm::dvec3(direction));
  scene_.lights.push_back(light);
  return *this;
}

SceneBuilder& SceneBuilder::sky(glm::vec3 radiance) {
  scene_.sky = radiance;
  return *this;
}

SceneBuilder& SceneBuilder::moving(glm::vec3 path) {
  path_ = path;
  scene_.animations.resize(1);
  return *this;
}

scene::Scene SceneBuilder::build() const {
  scene::Scene scene = scene_;
  if (scene.materials.empty()) scene.materials.emplace_back();
  return scene;
}

const glm::vec4& Texels::at(int x, int y, int layer) const {
  if (x < 0 || y < 0 || layer < 0 || x >= width || y >= height || layer >= layers)
    throw std::out_of_range("no such texel");
  return values[(test::at(layer) * test::at(height) + test::at(y)) * test::at(width) + test::at(x)];
}

glm::vec4 Texels::mean() const {
  glm::dvec4 sum(0);
  for (const glm::vec4& value : values) sum += glm::dvec4(value);
  return glm::vec4(sum / static_cast<double>(values.size()));
}

const Registry& all_passes() {
  static const Registry registry = [] {
    Registry loaded;
    Diagnostics diagnostics;
    plugins::load_plugins({.dirs = {LOOM_BINARY_DIR "/lib/loom/passes"}, .installed = false}, loaded, diagnostics);
    if (diagnostics.has_errors()) throw Error(diagnostics);
    return loaded;
  }();
  return registry;
}

Bench::Bench(Device& device, scene::Scene scene)
    : device_(device),
      scene_(std::move(scene)),
      facts_(scene::compute_facts(scene_)),
      gpu_(scene::GpuScene::create(scene_)) {}

Bench::~Bench() = default;

void Bench::look(glm::dvec3 eye, glm::dvec3 target, double half_angle, glm::dvec3 up) {
  camera_ = {};
  camera_.eye = eye;
  camera_.target = target;
  camera_.up = up;
  camera_.yfov_rad = 2 * half_angle;
  camera_.znear = 1e-3 * glm::length(target - eye);
}

void Bench::look_down(double half, double height) {
  camera_ = {};
  camera_.eye = {0, height, 0};
  camera_.target = {0, 0, 0};
  camera_.up = {0, 0, -1};
  camera_.orthographic = true;
  camera_.ymag = half;
  camera_.xmag = half;
  camera_.znear = 1e-3 * height;
}

void Bench::render(const std::string& pipeline, const BenchOptions& options) {
  graph::CompileOptions compile;
  compile.frame_size = options.size;
  compile.overrides = options.set;
  compile.requested = options.requested;
  compile.alias = options.alias;
  compile.prune = options.prune;
  compile.disabled_rules = options.disabled_rules;
  auto result = pipeline.find('{') == std::string::npos
                    ? graph::compile_file(LOOM_SOURCE_DIR "/pipelines/" + pipeline, all_passes(), facts_, compile)
                    : graph::compile_text(pipeline, "test.json", all_passes(), facts_, compile);
  if (!result.graph) throw BadInput(result.diagnostics);
  renderer_ = graph::Renderer::create(std::move(*result.graph), device_,
                                      {.poison = options.poison, .fingerprints = options.prune});
  size_ = options.size;
  seed_ = options.seed;
  frame_ = 0;
  for (int i = 0; i < options.frames; ++i) next_frame(options.jitter);
}

void Bench::pose(double time_s) {
  if (scene::pose(scene_, time_s)) gpu_->update();
}

void Bench::next_frame(glm::dvec2 jitter) {
  block_ = scene::make_camera(camera_, scene_, size_, jitter);
  renderer_->render(*gpu_, block_, {.index = frame_++, .seed = seed_});
}

void Bench::set(const std::string& pass, const std::string& param, const std::string& value) {
  Diagnostics diagnostics;
  if (renderer_->set_param(pass, param, value, diagnostics) != graph::ParamChange::applied)
    throw BadInput(std::move(diagnostics));
}

void Bench::reset() {
  renderer_->reset();
  frame_ = 0;
}

Texels Bench::image(const std::string& pipeline, const std::string& output, BenchOptions options) {
  options.requested.push_back(output);
  render(pipeline, options);
  return read(output);
}

Texels Bench::read(const std::string& output) const {
  const Texture* texture = renderer_->output(output);
  if (texture == nullptr) throw std::runtime_error("output " + output + " is absent");
  const TextureDesc& desc = texture->desc();
  return {desc.width, desc.height, desc.depth, texture->read()};
}

bool Bench::absent(const std::string& output) const { return renderer_->output(output) == nullptr; }

glm::dvec3 Bench::position(int x, int y, double depth) const {
  const glm::dvec2 shift(block_.right.w, block_.up.w);
  const glm::dvec2 s = 2. * (glm::dvec2(x, y) + .5) * glm::dvec2(block_.size.z, block_.size.w) - 1. + shift;
  const glm::dvec3 across = s.x * glm::dvec3(block_.right) + s.y * glm::dvec3(block_.up);
  if (block_.eye.w > .5f) return glm::dvec3(block_.eye) + across + depth * glm::dvec3(block_.forward);
  return glm::dvec3(block_.eye) + depth * glm::normalize(glm::dvec3(block_.forward) + across);
}

TexelRay texel_ray(const interop::LightFace& face, int x, int y, int size) {
  const glm::dvec2 q = (2. * glm::dvec2(x, y) + 1.) / static_cast<double>(size) - 1.;
  const glm::dvec3 right(face.right), up(face.up), forward(face.forward), origin(face.origin);
  const double plane = 4 * glm::length(right) * glm::length(up) / (static_cast<double>(size) * size);
  const glm::dvec3 across = q.x * right + q.y * up;
  if (static_cast<int>(face.forward.w) == LIGHT_DIRECTIONAL) return {origin + across, forward, plane};
  const double length = glm::length(forward + across);
  return {origin, (forward + across) / length, plane / (length * length * length)};
}

}  // namespace loom::test
