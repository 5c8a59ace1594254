#include "measure/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

namespace loom::measure {
namespace {

constexpr int blocks_across = 8;
constexpr int resamples = 1000;

struct Block {
  double sum = 0, count = 0;
};

std::vector<Block> blocks_of(const std::vector<double>& values, int width, int height) {
  const int across = std::min(blocks_across, width), down = std::min(blocks_across, height);
  std::vector<Block> blocks(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value =
          values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      if (std::isnan(value)) continue;
      Block& block = blocks[static_cast<std::size_t>(y * down / height * across + x * across / width)];
      block.sum += value;
      block.count += 1;
    }
  }
  std::erase_if(blocks, [](const Block& block) { return block.count == 0; });
  return blocks;
}

}  // namespace

Interval block_bootstrap(const std::vector<double>& values, int width, int height) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Block> blocks = blocks_of(values, width, height);
  if (blocks.empty()) return {none, none};
  std::mt19937 random(1);  // fixed: an interval is part of a result, which must not change by itself
  std::vector<double> means;
  for (int i = 0; i < resamples; ++i) {
    Block total;
    for (std::size_t drawn = 0; drawn < blocks.size(); ++drawn) {
      const Block& block = blocks[random() % blocks.size()];
      total.sum += block.sum;
      total.count += block.count;
    }
    means.push_back(total.sum / total.count);
  }
  std::sort(means.begin(), means.end());
  return {means[resamples * 25 / 1000], means[resamples * 975 / 1000 - 1]};
}

}  // namespace loom::measure
