#pragma once
// The transfer curve of sRGB, IEC 61966-2-1.
#include <cmath>

namespace loom {

template <class T>
T srgb_to_linear(T encoded) {
  return encoded <= T(.04045) ? encoded / T(12.92) : std::pow((encoded + T(.055)) / T(1.055), T(2.4));
}

template <class T>
T linear_to_srgb(T linear) {
  return linear <= T(.0031308) ? linear * T(12.92) : T(1.055) * std::pow(linear, T(1 / 2.4)) - T(.055);
}

}  // namespace loom
