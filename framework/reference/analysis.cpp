// Measurements of a scene. Light is the path tracer's: irradiance at a point of a surface is what a camera of one pixel
// right before it finds there, and radiance at a probe what six cameras see, each with samples enough that noise, which
// is estimated apart, does not count as detail.
#include "reference/analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/embree_scene.h"
#include "reference/path_tracer.h"
#include "reference/sampler.h"
#include "scene/world.h"

namespace loom::reference {
namespace {

constexpr double pi = std::numbers::pi;

constexpr std::uint32_t samples = replicates;  // a round of the path tracer
constexpr int seen_side = 64;                  // pixels of the picture by which what is seen is bounded
/// Share of the reflected light that may lie outside of the lit box.
constexpr double outside = 1e-3;
/// Thickness that this share of the surface is below counts as the thinnest: less is a sliver or an intersection.
constexpr double thin_share = .01;

struct SurfaceSample {
  glm::dvec3 position;  ///< relative to the origin
  glm::dvec3 normal;    ///< unit, towards the front
};

/// Points of equal area, by inversion of the cumulative area at low-discrepancy places.
std::vector<SurfaceSample> sample_surface(const scene::Scene& scene, const glm::dvec3& origin, int count) {
  std::vector<scene::WorldTriangle> triangles;
  std::vector<double> cumulative;
  double area = 0;
  scene::for_each_triangle(scene, [&](const scene::WorldTriangle& triangle) {
    const double of_this = .5 * glm::length(triangle.cross());
    if (!(of_this > 0)) return;
    triangles.push_back(triangle);
    cumulative.push_back(area += of_this);
  });
  std::vector<SurfaceSample> points;
  if (triangles.empty()) return points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double at = (i + .5) / count * area;
    const auto found = std::lower_bound(cumulative.begin(), cumulative.end(), at) - cumulative.begin();
    const auto& triangle = triangles[std::min(static_cast<std::size_t>(found), triangles.size() - 1)];
    const glm::vec2 u = PathSampler(0, 0, 0, static_cast<std::uint32_t>(i)).pair(0);
    const double root = std::sqrt(static_cast<double>(u.x)), second = root * static_cast<double>(u.y);
    const glm::dvec3 position =
        (1 - root) * triangle.corners[0] + (root - second) * triangle.corners[1] + second * triangle.corners[2];
    points.push_back({position - origin, glm::normalize(triangle.cross())});
  }
  return points;
}

interop::Camera camera_at(const glm::dvec3& eye, const glm::dvec3& forward, const glm::dvec3& up, double half,
                          int pixels) {
  interop::Camera camera{};
  camera.eye = glm::vec4(glm::vec3(eye), 0);
  camera.right = glm::vec4(glm::vec3(half * glm::normalize(glm::cross(forward, up))), 0);
  camera.up = glm::vec4(glm::vec3(half * up), 0);
  camera.forward = glm::vec4(glm::vec3(forward), 0);
  const auto side = static_cast<float>(pixels);
  camera.size = {side, side, 1 / side, 1 / side};
  return camera;
}

glm::dvec3 across(const glm::dvec3& n) {
  return glm::normalize(glm::cross(n, std::abs(n.x) < .5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
}

double channel_mean(const glm::dvec3& v) { return (v.r + v.g + v.b) / 3; }

/// Radiance that the surface in a pixel reflects, mean over channels.
double reflected(const PixelSums& pixel) {
  return channel_mean(Film::mean(pixel, Layer::albedo) *
                      (Film::mean(pixel, Layer::direct) + Film::mean(pixel, Layer::indirect))) /
         pi;
}

struct Box {
  glm::dvec3 low{0}, high{0};
};

/// The box that all but `outside` of the weight lies in, a sixth of it beyond each face.
Box box_of(const std::vector<std::pair<glm::dvec3, double>>& points) {
  Box box;
  const double total =
      std::accumulate(points.begin(), points.end(), 0., [](double sum, const auto& p) { return sum + p.second; });
  if (!(total > 0)) return box;
  for (int axis = 0; axis < 3; ++axis) {
    auto sorted = points;
    std::sort(sorted.begin(), sorted.end(),
              [axis](const auto& a, const auto& b) { return a.first[axis] < b.first[axis]; });
    const auto edge = [&](auto first, auto last) {
      double sum = 0;
      for (; first != last; ++first)
        if ((sum += first->second) > outside / 6 * total) return first->first[axis];
      return sorted.front().first[axis];
    };
    box.low[axis] = edge(sorted.begin(), sorted.end());
    box.high[axis] = edge(sorted.rbegin(), sorted.rend());
  }
  return box;
}

class Measurement {
 public:
  Measurement(const scene::Scene& scene, const scene::Camera& camera, const AnalysisOptions& options)
      : scene_(scene), camera_(camera), options_(options), bounds_(scene::world_box(scene)) {}

  SceneMeasurements run() {
    SceneMeasurements result;
    if (bounds_.empty()) return result;
    origin_ = .5 * (bounds_.low + bounds_.high);
    points_ = sample_surface(scene_, origin_, options_.surface_points);
    if (points_.empty()) return result;
    const PathTracer tracer(scene_, origin_, {});
    const Box lit = lit_box(tracer);
    result.lit_min = lit.low + origin_;
    result.lit_max = lit.high + origin_;
    const Box seen = seen_box(tracer);
    result.seen_min = seen.low + origin_;
    result.seen_max = seen.high + origin_;
    geometry_.emplace(scene_, origin_);
    find_thinnest(result);
    find_bands(tracer, lit, result);
    return result;
  }

 private:
  /// Irradiance times albedo at points of both sides.
  [[nodiscard]] Box lit_box(const PathTracer& tracer) const {
    std::vector<std::pair<glm::dvec3, double>> weights(2 * points_.size());
    // Near enough that nothing stands between, far enough for the digits of a float.
    const double before = 1e-5 * bounds_.diagonal();
    oneapi::tbb::parallel_for(std::size_t{0}, weights.size(), [&](std::size_t i) {
      const SurfaceSample& point = points_[i / 2];
      const glm::dvec3 n = i % 2 == 0 ? point.normal : -point.normal;
      Film film({1, 1}, {}, i);
      tracer.accumulate(film, camera_at(point.position + before * n, -n, across(n), 1e-3, 1), samples);
      weights[i] = {point.position, reflected(film.pixel(0, 0))};
    });
    return box_of(weights);
  }

  [[nodiscard]] Box seen_box(const PathTracer& tracer) const {
    const glm::ivec2 size(seen_side);
    const interop::Camera camera = view_of(camera_, scene_, size, origin_);
    Film film(size, {}, 0);
    tracer.accumulate(film, camera, samples);
    std::vector<std::pair<glm::dvec3, double>> points;
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const PixelSums& pixel = film.pixel(x, y);
        if (pixel.hits == 0) continue;
        const double a = 2 * (x + .5) / size.x - 1, b = 1 - 2 * (y + .5) / size.y;
        const glm::dvec3 plane = a * glm::dvec3(camera.right) + b * glm::dvec3(camera.up);
        const bool orthographic = camera.eye.w != 0;
        const glm::dvec3 eye = glm::dvec3(camera.eye) + (orthographic ? plane : glm::dvec3(0));
        const glm::dvec3 ray = glm::normalize(glm::dvec3(camera.forward) + (orthographic ? glm::dvec3(0) : plane));
        // A pixel's mean depth may lie a little off the surface.
        points.emplace_back(
            glm::clamp(eye + pixel.depth / pixel.hits * ray, bounds_.low - origin_, bounds_.high - origin_), 1);
      }
    }
    return box_of(points);
  }

  struct Crossing {
    double distance;
    bool from_behind;  ///< the ray comes out of the surface's back
  };

  [[nodiscard]] std::optional<Crossing> next_surface(const glm::dvec3& from, const glm::dvec3& direction) const {
    alignas(64) std::array<int, lanes> valid{-1};  // as Embree asks for
    RTCRayHit16 rays{};
    rays.ray.org_x[0] = static_cast<float>(from.x);
    rays.ray.org_y[0] = static_cast<float>(from.y);
    rays.ray.org_z[0] = static_cast<float>(from.z);
    rays.ray.dir_x[0] = static_cast<float>(direction.x);
    rays.ray.dir_y[0] = static_cast<float>(direction.y);
    rays.ray.dir_z[0] = static_cast<float>(direction.z);
    rays.ray.tnear[0] = static_cast<float>(1e-6 * bounds_.diagonal());
    rays.ray.tfar[0] = std::numeric_limits<float>::infinity();
    rays.ray.mask[0] = ~0U;
    rays.hit.geomID[0] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][0] = RTC_INVALID_GEOMETRY_ID;
    geometry_->intersect(valid.data(), rays, false);
    if (rays.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    glm::vec3 a, b, c;
    geometry_->corners({.geometry = rays.hit.geomID[0], .triangle = rays.hit.primID[0], .uv = {}}, a, b, c);
    const Geometry& hit = geometry_->geometries()[rays.hit.geomID[0]];
    const glm::dvec3 front(glm::cross(b - a, c - a) * hit.orientation);
    return Crossing{static_cast<double>(rays.ray.tfar[0]),
                    glm::dot(front, direction) > 0 && !hit.material->double_sided};
  }

  /// From each point into what is behind it: solid as far as the next surface shows its back.
  void find_thinnest(SceneMeasurements& result) const {
    std::vector<double> thickness;
    for (const SurfaceSample& point : points_) {
      const auto crossing = next_surface(point.position, -point.normal);
      if (crossing && crossing->from_behind) thickness.push_back(crossing->distance);
    }
    const auto all = static_cast<double>(points_.size());
    result.sheets = 1 - static_cast<double>(thickness.size()) / all;
    std::sort(thickness.begin(), thickness.end());
    const auto index = static_cast<std::size_t>(thin_share * all);
    if (index < thickness.size()) result.thinnest_occluder = thickness[index];
  }

  /// What a probe sees, texel by texel of a cube.
  struct View {
    std::vector<glm::dvec3> direction;
    std::vector<double> solid_angle;
    std::vector<double> open;                     ///< 1 where nothing is near
    std::array<std::vector<double>, 2> radiance;  ///< two independent estimates, whose noise does not correlate
  };

  [[nodiscard]] View look_around(const std::array<const PathTracer*, 2>& tracers, const glm::dvec3& eye) const {
    constexpr std::array<glm::dvec3, 6> axes{glm::dvec3(1, 0, 0),  glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0),
                                             glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1),  glm::dvec3(0, 0, -1)};
    const double near = .1 * bounds_.diagonal();
    const int face_side = options_.face_side;
    View view;
    for (const glm::dvec3& forward : axes) {
      const glm::dvec3 up = across(forward);
      const interop::Camera camera = camera_at(eye, forward, up, 1, face_side);
      std::array<Film, 2> films{Film(glm::ivec2(face_side), {}, 0), Film(glm::ivec2(face_side), {}, 1)};
      for (std::size_t k = 0; k < 2; ++k) tracers.at(k)->accumulate(films.at(k), camera, samples);
      for (int y = 0; y < face_side; ++y) {
        for (int x = 0; x < face_side; ++x) {
          const double a = 2 * (x + .5) / face_side - 1, b = 1 - 2 * (y + .5) / face_side;
          const double square = 1 + a * a + b * b;
          view.direction.push_back(glm::normalize(forward + a * glm::dvec3(camera.right) + b * glm::dvec3(camera.up)));
          view.solid_angle.push_back(4. / (face_side * face_side) / (square * std::sqrt(square)));
          const PixelSums& pixel = films[0].pixel(x, y);
          view.open.push_back(pixel.hits == 0 || pixel.depth / pixel.hits > near ? 1 : 0);
          for (std::size_t k = 0; k < 2; ++k) view.radiance.at(k).push_back(reflected(films.at(k).pixel(x, y)));
        }
      }
    }
    return view;
  }

  /// Energy by band without any coefficient, by the addition theorem:
  ///   Σ_m c_lm·c'_lm = (2l+1)/4π · Σ_ij w_i w_j f_i g_j P_l(⟨ω_i,ω_j⟩);
  /// that of all bands together is Σ_i w_i f_i g_i.
  struct Spectrum {
    std::array<double, SceneMeasurements::bands> energy{};
    double all = 0;

    void add(const View& view, const std::vector<double>& f, const std::vector<double>& g) {
      for (std::size_t i = 0; i < f.size(); ++i) {
        all += view.solid_angle[i] * f[i] * g[i];
        const double weighted = view.solid_angle[i] * f[i] / (4 * pi);
        if (weighted == 0) continue;
        for (std::size_t j = 0; j < g.size(); ++j) {
          const double cosine = glm::dot(view.direction[i], view.direction[j]);
          const double product = weighted * view.solid_angle[j] * g[j];
          double before = 0, now = 1;
          for (std::size_t l = 0; l < energy.size(); ++l) {
            const auto order = static_cast<double>(l);
            energy.at(l) += (2 * order + 1) * product * now;
            before = std::exchange(now, ((2 * order + 1) * cosine * now - order * before) / (order + 1));
          }
        }
      }
    }
    void add(const Spectrum& other) {
      for (std::size_t l = 0; l < energy.size(); ++l) energy.at(l) += other.energy.at(l);
      all += other.all;
    }
    [[nodiscard]] std::array<double, SceneMeasurements::bands> shares() const {
      auto result = energy;
      for (double& share : result) share = all > 0 ? share / all : 0;
      return result;
    }
  };

  /// Not where most of what a probe sees shows its back: that is the inside of something.
  [[nodiscard]] bool in_free_space(const glm::dvec3& at) const {
    constexpr int rays = 64;
    int backs = 0;
    for (int i = 0; i < rays; ++i) {
      // A spiral of equal solid angles.
      const double z = 1 - (2 * i + 1.) / rays, angle = i * pi * (3 - std::sqrt(5.)), r = std::sqrt(1 - z * z);
      const auto crossing = next_surface(at, {r * std::cos(angle), r * std::sin(angle), z});
      backs += crossing && crossing->from_behind ? 1 : 0;
    }
    return backs < rays / 4;
  }

  void find_bands(const PathTracer& tracer, const Box& lit, SceneMeasurements& result) const {
    const PathTracer other(scene_, origin_, {.seed = 1});
    const int side = options_.probes, count = side * side * side;
    std::vector<std::pair<Spectrum, Spectrum>> spectra(static_cast<std::size_t>(count));
    std::vector<char> free(spectra.size(), 0);
    oneapi::tbb::parallel_for(0, count, [&](int i) {
      const glm::dvec3 cell(i % side, i / side % side, i / (side * side));
      const glm::dvec3 at = lit.low + (cell + .5) / static_cast<double>(side) * (lit.high - lit.low);
      if (!in_free_space(at)) return;
      const auto slot = static_cast<std::size_t>(i);
      free[slot] = 1;
      const View view = look_around({&tracer, &other}, at);
      spectra[slot].first.add(view, view.radiance[0], view.radiance[1]);
      spectra[slot].second.add(view, view.open, view.open);
    });
    Spectrum radiance, visibility;
    for (std::size_t i = 0; i < spectra.size(); ++i) {
      radiance.add(spectra[i].first);
      visibility.add(spectra[i].second);
      result.probes += free[i];
    }
    result.radiance = radiance.shares();
    result.visibility = visibility.shares();
  }

  const scene::Scene& scene_;
  const scene::Camera& camera_;
  AnalysisOptions options_;
  scene::Box bounds_;
  glm::dvec3 origin_{0};
  std::vector<SurfaceSample> points_;
  std::optional<EmbreeScene> geometry_;
};

}  // namespace

SceneMeasurements measure_scene(const scene::Scene& scene, const scene::Camera& camera,
                                const AnalysisOptions& options) {
  return Measurement(scene, camera, options).run();
}

}  // namespace loom::reference
