#include "measure/sampling.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "core/srgb.h"

namespace loom::measure {
namespace {

/// The bits of `i` mirrored: van der Corput's sequence times 2³².
std::uint32_t mirrored(std::uint32_t i) {
  std::uint32_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit) reversed |= ((i >> bit) & 1u) << (31 - bit);
  return reversed;
}

bool is_display(const graph::ReadImage& image) { return image.quantity == "display"; }

template <class Curve>
glm::dvec4 through(const glm::dvec4& value, Curve curve) {
  return {curve(value.r), curve(value.g), curve(value.b), value.a};
}

}  // namespace

std::vector<glm::dvec2> jitter(int samples) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(samples));
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [](auto a, auto b) { return mirrored(a) < mirrored(b); });
  std::vector<glm::dvec2> offsets(order.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const double x = (order[rank] + .5) / samples - .5;
    const double y = (static_cast<double>(rank) + .5) / samples - .5;
    offsets[order[rank]] = {x, y};
  }
  return offsets;
}

void Mean::add(const graph::ReadImage& image) {
  if (count_ == 0) {
    first_ = {.width = image.width, .height = image.height, .layers = image.layers, .texels = {}};
    first_.quantity = image.quantity;
    sum_.assign(image.texels.size(), glm::dvec4(0));
  }
  const bool display = is_display(image);
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const glm::dvec4 value(image.texels[i]);
    sum_[i] += display ? through(value, srgb_to_linear<double>) : value;
  }
  ++count_;
}

graph::ReadImage Mean::image() const {
  graph::ReadImage mean = first_;
  mean.texels.reserve(sum_.size());
  const bool display = is_display(first_);
  for (const glm::dvec4& sum : sum_) {
    const glm::dvec4 value = sum / static_cast<double>(count_);
    mean.texels.emplace_back(display ? through(value, linear_to_srgb<double>) : value);
  }
  return mean;
}

}  // namespace loom::measure
