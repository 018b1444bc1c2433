// SPDX-License-Identifier: Apache-2.0
// Natural logarithm and exponential with reproducible bits. The C library's may differ in the last bit
// between versions; these use only operations fixed by IEEE 754.
#pragma once

#include <bit>
#include <cstdint>

namespace ifog {

// ln(x) for normal x > 0, error below 2 units in the last place. x = m 2^k with m in [sqrt(1/2), sqrt(2)),
// and ln m = 2 atanh(s), s = (m-1)/(m+1), |s| < 0.1716, by its series to s^19 (remainder below 2e-17).
[[nodiscard]] constexpr double logarithm(double x) noexcept {
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;  // short enough that k * kLn2High is exact
  constexpr double kLn2Low = 0x1.ef35793c76730p-45;
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcdULL;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
  const std::int64_t k = static_cast<std::int64_t>(bits - kSqrtHalf) >> 52;
  const double m = std::bit_cast<double>(bits - (static_cast<std::uint64_t>(k) << 52U));
  const double f = m - 1.0;
  const double s = f / (m + 1.0);
  const double t = s * s;
  const double t2 = t * t;
  const double t4 = t2 * t2;
  // Estrin's scheme, for instruction-level parallelism.
  const double low = (1.0 / 3 + t * (1.0 / 5)) + t2 * (1.0 / 7 + t * (1.0 / 9));
  const double high = (1.0 / 11 + t * (1.0 / 13)) + t2 * (1.0 / 15 + t * (1.0 / 17) + t2 * (1.0 / 19));
  const double tail = 2.0 * s * t * (low + t4 * high);
  const auto kd = static_cast<double>(k);
  return kd * kLn2High + (2.0 * s + (tail + kd * kLn2Low));
}

// e^x for -700 < x < 700, relative error below 1e-15.
[[nodiscard]] constexpr double exponential(double x) noexcept {
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;
  constexpr double kLn2Low = 0x1.ef35793c76730p-45;
  const double scaled = x * 0x1.71547652b82fep0;
  const auto k = static_cast<std::int64_t>(scaled + (scaled < 0 ? -0.5 : 0.5));
  const auto kd = static_cast<double>(k);
  const double r = (x - kd * kLn2High) - kd * kLn2Low;  // |r| <= ln(2) / 2
  // Taylor series to r^13 (remainder below 5e-18) by Estrin's scheme.
  const double r2 = r * r;
  const double r4 = r2 * r2;
  const double low = (1.0 + r) + r2 * (1.0 / 2 + r * (1.0 / 6));
  const double middle = (1.0 / 24 + r * (1.0 / 120)) + r2 * (1.0 / 720 + r * (1.0 / 5040));
  const double high = (1.0 / 40320 + r * (1.0 / 362880)) + r2 * (1.0 / 3628800 + r * (1.0 / 39916800));
  const double last = 1.0 / 479001600 + r * (1.0 / 6227020800);
  const double sum = low + r4 * (middle + r4 * (high + r4 * last));
  return sum * std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52U);
}

}  // namespace ifog
