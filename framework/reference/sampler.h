#pragma once
// Low-discrepancy points: Owen-scrambled Sobol pairs, padded. Every (pixel, replicate, seed) has a scramble of its own,
// so that replicates are independent and their spread tells the error.
#include <array>
#include <cstdint>

#include <glm/vec2.hpp>

namespace loom::reference {

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014): a bijection of 64 bits that mixes well.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x ^= x >> 30U;
  x *= 0xbf58476d1ce4e5b9U;
  x ^= x >> 27U;
  x *= 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x >> 4U) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4U);
  x = ((x >> 2U) & 0x33333333U) | ((x & 0x33333333U) << 2U);
  return ((x >> 1U) & 0x55555555U) | ((x & 0x55555555U) << 1U);
}

/// Laine–Karras permutation with Vegdahl's 2021 constants: each output bit depends on the bits below it alone, so that
/// on reversed bits it is a nested uniform (Owen) scramble.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16U) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return x;
}

namespace detail {
/// The second Sobol dimension, bits reversed, as four tables of bytes of the index. Its generator matrix is Pascal's
/// triangle mod 2: column k+1 is column k plus itself shifted down by one.
constexpr std::array<std::array<std::uint32_t, 256>, 4> make_second_dimension() {
  std::array<std::array<std::uint32_t, 256>, 4> table{};
  std::uint32_t column = 1U << 31U;
  for (std::size_t bit = 0; bit < 32; ++bit, column ^= column >> 1U) {
    const std::uint32_t reversed = reverse_bits(column);
    for (std::size_t value = 0; value < 256; ++value) {
      if ((value >> (bit % 8)) & 1U) table[bit / 8][value] ^= reversed;
    }
  }
  return table;
}
inline constexpr auto second_dimension = make_second_dimension();

/// [0, 1) in steps of 2⁻²⁴, so that no value rounds to 1.
constexpr float to_unit(std::uint32_t bits) { return static_cast<float>(bits >> 8U) * 0x1p-24F; }
}  // namespace detail

/// The random numbers of one path: point `index` of the sequence that belongs to `pixel`, `replicate` and `seed`.
class PathSampler {
 public:
  PathSampler() = default;
  PathSampler(std::uint64_t seed, std::uint64_t pixel, std::uint32_t replicate, std::uint32_t index)
      : key_(mix_bits(mix_bits(seed + 0x9e3779b97f4a7c15U) ^ mix_bits((pixel << 4U | replicate) + 1U))),
        reversed_index_(reverse_bits(index)) {}

  /// A point of [0,1)² of the (0,2)-sequence number `set`; sets are independent (index shuffled, digits scrambled,
  /// after Burley 2020).
  [[nodiscard]] glm::vec2 pair(std::uint32_t set) const {
    const std::uint64_t bits = mix_bits(key_ + set * 0x9e3779b97f4a7c15U);
    const auto low = static_cast<std::uint32_t>(bits);
    const auto high = static_cast<std::uint32_t>(bits >> 32U);
    const std::uint32_t index = reverse_bits(scramble_reversed(reversed_index_, low));
    const auto& table = detail::second_dimension;
    const std::uint32_t second = table[0][index & 255U] ^ table[1][(index >> 8U) & 255U] ^
                                 table[2][(index >> 16U) & 255U] ^ table[3][index >> 24U];
    return {detail::to_unit(reverse_bits(scramble_reversed(index, high))),
            detail::to_unit(reverse_bits(scramble_reversed(second, high ^ (low * 0x9e3779b9U + 0x7f4a7c15U))))};
  }

 private:
  std::uint64_t key_ = 0;
  std::uint32_t reversed_index_ = 0;
};

}  // namespace loom::reference
