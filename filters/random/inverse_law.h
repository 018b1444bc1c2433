// SPDX-License-Identifier: Apache-2.0
// Exponential distribution by inversion: e = -ln u for u = (bits + 1/2) 2^-32, two at a time, without
// division or branch, so that it takes constant time. (A ziggurat is slower here because of mispredicted
// rejections.)
//
// u = 2^-k m, m in [1, 2). With c the middle of the 1/256 of [1, 2) that contains m,
//   -ln u = k ln 2 - ln c - ln(1 + r),  r = m / c - 1,  |r| < 2^-8.9,
// and ln(1 + r) = r - r^2/2 + r^3/3 to 5e-12; neighbouring values of -ln u differ by at least 2.3e-10. The
// table uses this project's logarithm at compile time, and all operations are fixed by IEEE 754 in a fixed
// order, so every machine gives the same bits.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "filters/random/log_exp.h"

namespace ifog {

// Two values in one vector register (SSE2 or NEON).
using DoublePair = double __attribute__((vector_size(16)));
using WordPair = std::uint64_t __attribute__((vector_size(16)));

struct InverseLawTable {
  static constexpr std::size_t kParts = 256;
  std::array<double, kParts> inverse{};    // 1 / c
  std::array<double, kParts> logarithm{};  // of 1 / c

  constexpr InverseLawTable() {
    for (std::size_t i = 0; i < kParts; ++i) {
      inverse[i] = 1.0 / (1.0 + (static_cast<double>(i) + 0.5) / kParts);
      logarithm[i] = ifog::logarithm(inverse[i]);
    }
  }
};

inline constexpr InverseLawTable kInverseLaw;

// A double with the exponent of 2^52 holds an integer in its lowest bits, so conversion is a subtraction.
inline constexpr std::uint64_t kIntegerExponent = std::bit_cast<std::uint64_t>(0x1p52);

// 2^32 u of the lower and the upper half of the bits, exactly.
[[nodiscard]] inline DoublePair scaled_uniforms(std::uint64_t bits) noexcept {
  using Halves = std::uint32_t __attribute__((vector_size(16)));
  constexpr auto kUpper = static_cast<std::uint32_t>(kIntegerExponent >> 32U);
  // Both halves as low words below that exponent.
  const Halves both = std::bit_cast<Halves>(WordPair{bits, 0});
  const Halves words = __builtin_shufflevector(both, Halves{kUpper, 0, 0, 0}, 0, 4, 1, 4);
  return std::bit_cast<DoublePair>(words) - (0x1p52 - 0.5);
}

[[nodiscard]] inline DoublePair uniform_deviates(std::uint64_t bits) noexcept {
  return scaled_uniforms(bits) * 0x1p-32;  // never 0 nor 1
}

[[nodiscard]] inline DoublePair exponential_deviates(std::uint64_t bits) noexcept {
  const auto scaled = std::bit_cast<WordPair>(scaled_uniforms(bits));
  // The exponent field of 2^32 u is 1023 + 32 - k.
  const DoublePair k = (0x1p52 + 1023 + 32) - std::bit_cast<DoublePair>((scaled >> 52U) | kIntegerExponent);
  const auto m = std::bit_cast<DoublePair>((scaled & 0x000fffffffffffffU) | 0x3ff0000000000000U);
  const WordPair part = (scaled >> 44U) & 255U;
  const DoublePair inverse{kInverseLaw.inverse[part[0]], kInverseLaw.inverse[part[1]]};
  const DoublePair logarithm{kInverseLaw.logarithm[part[0]], kInverseLaw.logarithm[part[1]]};
  const DoublePair r = m * inverse - 1.0;
  const DoublePair tail = r - (r * r) * (0.5 - r * (1.0 / 3));
  return (k * 0x1.62e42fefa39efp-1 + logarithm) - tail;
}

}  // namespace ifog
