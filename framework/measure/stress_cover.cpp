#include "measure/stress_cover.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>

namespace loom::measure {
namespace {

/// Which pairs of values are still missing. Values of all parameters are numbered through.
class Missing {
 public:
  Missing(const std::vector<int>& counts, const std::function<bool(const ValuePair&)>& wanted) {
    for (const int count : counts) {
      first_.push_back(total_);
      total_ += static_cast<std::size_t>(count);
    }
    missing_.assign(total_ * total_, 0);
    const int parameters = static_cast<int>(counts.size());
    for (int a = 0; a < parameters; ++a) {
      for (int b = a + 1; b < parameters; ++b) {
        for (int i = 0; i < counts[static_cast<std::size_t>(a)]; ++i) {
          for (int k = 0; k < counts[static_cast<std::size_t>(b)]; ++k) {
            if (wanted({a, i, b, k})) open_.push_back({a, i, b, k});
          }
        }
      }
    }
    for (const ValuePair& pair : open_) at(pair.a, pair.value_a, pair.b, pair.value_b) = 1;
  }

  /// A pair that is missing, or null where there is none.
  const ValuePair* next() {
    while (!open_.empty() && at(open_.back().a, open_.back().value_a, open_.back().b, open_.back().value_b) == 0) {
      open_.pop_back();
    }
    return open_.empty() ? nullptr : &open_.back();
  }
  [[nodiscard]] bool has(int a, int value_a, int b, int value_b) const {
    return missing_[index(a, value_a, b, value_b)] != 0;
  }
  void found(int a, int value_a, int b, int value_b) { at(a, value_a, b, value_b) = 0; }

 private:
  [[nodiscard]] std::size_t index(int a, int value_a, int b, int value_b) const {
    const std::size_t i = first_[static_cast<std::size_t>(a)] + static_cast<std::size_t>(value_a);
    const std::size_t k = first_[static_cast<std::size_t>(b)] + static_cast<std::size_t>(value_b);
    return std::min(i, k) * total_ + std::max(i, k);
  }
  char& at(int a, int value_a, int b, int value_b) { return missing_[index(a, value_a, b, value_b)]; }

  std::vector<std::size_t> first_;
  std::size_t total_ = 0;
  std::vector<char> missing_;
  std::vector<ValuePair> open_;
};

}  // namespace

std::vector<std::vector<int>> pairwise_cover(const std::vector<int>& counts, std::uint32_t seed,
                                             const std::function<bool(const ValuePair&)>& wanted) {
  constexpr int open = -1;
  const int parameters = static_cast<int>(counts.size());
  std::mt19937 random(seed);
  Missing missing(counts, wanted);
  std::vector<std::vector<int>> rows;
  std::vector<int> order(counts.size());
  std::iota(order.begin(), order.end(), 0);
  while (const ValuePair* pair = missing.next()) {
    std::vector<int> row(counts.size(), open);
    row[static_cast<std::size_t>(pair->a)] = pair->value_a;
    row[static_cast<std::size_t>(pair->b)] = pair->value_b;
    std::shuffle(order.begin(), order.end(), random);
    for (const int p : order) {
      int& value = row[static_cast<std::size_t>(p)];
      if (value != open) continue;
      const int count = counts[static_cast<std::size_t>(p)];
      const int start = static_cast<int>(random() % static_cast<unsigned>(count));  // among equals, any
      int most = -1;
      for (int i = 0; i < count; ++i) {
        const int candidate = (start + i) % count;
        int brings = 0;
        for (int other = 0; other < parameters; ++other) {
          const int its = row[static_cast<std::size_t>(other)];
          if (other != p && its != open && missing.has(p, candidate, other, its)) ++brings;
        }
        if (brings > most) {
          most = brings;
          value = candidate;
        }
      }
    }
    for (int a = 0; a < parameters; ++a) {
      for (int b = a + 1; b < parameters; ++b) {
        missing.found(a, row[static_cast<std::size_t>(a)], b, row[static_cast<std::size_t>(b)]);
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace loom::measure
