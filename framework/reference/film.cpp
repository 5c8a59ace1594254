#include "reference/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "loom/diagnostic.h"

namespace loom::reference {
namespace {

bool finite(const glm::vec3& v) { return std::isfinite(v.x + v.y + v.z); }

bool finite(const Sample& s) {
  return finite(s.radiance) && finite(s.direct) && finite(s.emitter) && finite(s.bounce) && finite(s.specular) &&
         finite(s.albedo) && finite(s.normal) && std::isfinite(s.depth);
}

/// Samples of replicate r among `count`.
double samples_of(std::uint32_t count, std::size_t r) {
  return static_cast<double>((count + replicates - 1 - static_cast<std::uint32_t>(r)) / replicates);
}

}  // namespace

Film::Film(glm::ivec2 size, FilmIdentity identity, std::uint64_t seed)
    : size_(size),
      identity_(identity),
      seeds_{seed},
      pixels_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {}

void Film::add(PixelSums& sums, const Sample& sample) {
  const std::size_t replicate = sums.count++ % replicates;
  if (!finite(sample)) {
    ++sums.non_finite;
    return;
  }
  sums.radiance[replicate] += glm::dvec3(sample.radiance);
  if (!sample.hit) return;
  ++sums.hits;
  sums.direct += glm::dvec3(sample.direct);
  sums.emitter += glm::dvec3(sample.emitter);
  sums.bounce += glm::dvec3(sample.bounce);
  sums.specular += glm::dvec3(sample.specular);
  sums.albedo += glm::dvec3(sample.albedo);
  sums.normal += glm::dvec3(sample.normal);
  sums.depth += static_cast<double>(sample.depth);
}

std::uint32_t Film::least_count() const {
  std::uint32_t least = pixels_.empty() ? 0 : pixels_.front().count;
  for (const auto& pixel : pixels_) least = std::min(least, pixel.count);
  return least;
}

std::uint32_t Film::most_count() const {
  std::uint32_t most = 0;
  for (const auto& pixel : pixels_) most = std::max(most, pixel.count);
  return most;
}

std::uint64_t Film::non_finite() const {
  std::uint64_t sum = 0;
  for (const auto& pixel : pixels_) sum += pixel.non_finite;
  return sum;
}

glm::dvec3 Film::mean(const PixelSums& sums, Layer layer) {
  glm::dvec3 total(0);
  switch (layer) {
    case Layer::radiance:
      for (const auto& sum : sums.radiance) total += sum;
      break;
    case Layer::direct:
      total = sums.direct;
      break;
    case Layer::emitter:
      total = sums.emitter;
      break;
    case Layer::bounce:
      total = sums.bounce;
      break;
    case Layer::indirect:
      total = sums.emitter + sums.bounce;
      break;
    case Layer::albedo:
      total = sums.albedo;
      break;
    case Layer::normal:
      total = sums.normal;
      break;
    case Layer::specular:
      total = sums.specular;
      break;
  }
  return total / std::max(1., static_cast<double>(sums.count));
}

glm::dvec3 Film::standard_error(const PixelSums& sums) {
  const auto groups = std::min<std::size_t>(sums.count, replicates);
  if (groups < 2) return glm::dvec3(0);
  const glm::dvec3 centre = mean(sums);
  // The mean is Σ wᵣ mᵣ with wᵣ = nᵣ/n; its variance is estimated by Σ wᵣ² (mᵣ − mean)² · R/(R−1).
  glm::dvec3 variance(0);
  for (std::size_t r = 0; r < groups; ++r) {
    const double n = samples_of(sums.count, r);
    const glm::dvec3 deviation = (sums.radiance[r] - n * centre) / static_cast<double>(sums.count);
    variance += deviation * deviation;
  }
  const auto g = static_cast<double>(groups);
  return glm::sqrt(variance * (g / (g - 1)));
}

double Film::relative_error() const {
  double sum = 0;
  for (const auto& pixel : pixels_) {
    const glm::dvec3 m = mean(pixel);
    const glm::dvec3 e = standard_error(pixel);
    const glm::dvec3 relative = e * e / (m * m + 1e-2);  // the same 1e-2 as relMSE has
    sum += relative.x + relative.y + relative.z;
  }
  return pixels_.empty() ? 0 : std::sqrt(sum / (3 * static_cast<double>(pixels_.size())));
}

ImageLayers Film::layers() const {
  ImageLayers image;
  image.width = size_.x;
  image.height = size_.y;
  constexpr std::array layers = {std::pair("", Layer::radiance),          std::pair("direct.", Layer::direct),
                                 std::pair("emitter.", Layer::emitter),   std::pair("bounce.", Layer::bounce),
                                 std::pair("indirect.", Layer::indirect), std::pair("albedo.", Layer::albedo),
                                 std::pair("normal.", Layer::normal)};
  const auto add = [&](const std::string& prefix, auto&& value) {
    std::vector<float>& r = image.channels[prefix + "R"];
    std::vector<float>& g = image.channels[prefix + "G"];
    std::vector<float>& b = image.channels[prefix + "B"];
    for (const PixelSums& pixel : pixels_) {
      const glm::vec3 v(value(pixel));
      r.push_back(v.x);
      g.push_back(v.y);
      b.push_back(v.z);
    }
  };
  for (const auto& [prefix, layer] : layers) {
    add(prefix, [which = layer](const PixelSums& pixel) { return mean(pixel, which); });
  }
  if (std::any_of(pixels_.begin(), pixels_.end(), [](const PixelSums& p) { return p.specular != glm::dvec3(0); })) {
    add("specular.", [](const PixelSums& pixel) { return mean(pixel, Layer::specular); });
  }
  add("stderr.", [](const PixelSums& pixel) { return standard_error(pixel); });
  for (const PixelSums& p : pixels_) {
    // Over the hits: a mean with the misses would be the depth of nothing at a silhouette.
    image.channels["depth.Z"].push_back(p.hits == 0 ? 0.F : static_cast<float>(p.depth / p.hits));
  }
  image.attributes["loom:quantity"] = "radiance";
  image.attributes["loom:spp"] = std::to_string(least_count());
  image.attributes["loom:bounces"] = identity_.bounces < 0 ? "unlimited" : std::to_string(identity_.bounces);
  return image;
}

void Film::merge(const Film& other) {
  if (size_ != other.size_ || !(identity_ == other.identity_)) {
    throw BadInput(
        "accumulations of different pictures cannot be merged: scene, camera, lights, size and bounces must agree");
  }
  for (const std::uint64_t seed : other.seeds_) {
    if (std::find(seeds_.begin(), seeds_.end(), seed) != seeds_.end()) {
      throw BadInput("both accumulations hold seed " + std::to_string(seed) +
                     ": the same samples would count twice; render one of them with another --seed");
    }
  }
  seeds_.insert(seeds_.end(), other.seeds_.begin(), other.seeds_.end());
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    PixelSums& a = pixels_[i];
    const PixelSums& b = other.pixels_[i];
    // Sample s of a pixel belongs to replicate s % 16: with whole rounds in front, that stays true of the sum.
    if (a.count % replicates != 0) throw BadInput("an unfinished round of samples cannot be merged: let the run end");
    for (std::size_t r = 0; r < replicates; ++r) a.radiance[r] += b.radiance[r];
    a.direct += b.direct;
    a.emitter += b.emitter;
    a.bounce += b.bounce;
    a.specular += b.specular;
    a.albedo += b.albedo;
    a.normal += b.normal;
    a.depth += b.depth;
    a.count += b.count;
    a.hits += b.hits;
    a.non_finite += b.non_finite;
  }
  seconds += other.seconds;
  rays += other.rays;
}

}  // namespace loom::reference
