// SPDX-License-Identifier: Apache-2.0
// Random numbers for simulation with equal bits on every machine: integers from philox, normal values by the
// inverse distribution (Wichura, "Algorithm AS 241: the percentage points of the normal distribution",
// Applied Statistics 37(3), 1988, PPND16), which needs only + − × ÷ and square roots here. The standard
// library's distributions and logarithm do not guarantee that.
#pragma once

#include <cstdint>

#include "filters/random/philox.h"

namespace ifog::simulate {

// Natural logarithm as a series; x > 0 and normal. Relative error below 4e-16.
[[nodiscard]] double plain_log(double x) noexcept;

// Quantile of the standard normal distribution, 0 < p < 1; relative error about 1e-15.
[[nodiscard]] double normal_quantile(double p) noexcept;

// One sequence of draws, identified by (seed, stream). Streams of one seed are independent, so an additional
// noise term or channel does not change the others.
class Draw {
 public:
  explicit Draw(std::uint64_t seed, std::uint32_t stream = 0) noexcept;

  [[nodiscard]] double uniform() noexcept;  // open interval (0, 1), 53 bits
  [[nodiscard]] double uniform(double low, double high) noexcept;
  [[nodiscard]] double log_uniform(double low, double high) noexcept;  // 0 < low <= high
  [[nodiscard]] double normal() noexcept;                              // mean 0, variance 1
  [[nodiscard]] std::uint64_t below(std::uint64_t n) noexcept;         // 0 … n − 1; n > 0
  [[nodiscard]] bool chance(double p) noexcept { return uniform() < p; }

 private:
  [[nodiscard]] std::uint64_t bits() noexcept;

  std::uint64_t block_ = 0;
  std::uint32_t stream_;
  std::array<std::uint32_t, 2> key_;
  std::uint64_t spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace ifog::simulate
