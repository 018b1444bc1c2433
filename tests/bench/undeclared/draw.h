// SPDX-License-Identifier: Apache-2.0
// Random draws of the scenario maker: a stream is a function of (seed, stream), so that a sensor is
// reproducible from its seed, and its noise does not depend on the environment's draws.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "filters/random/philox.h"

namespace ifog::undeclared {

class Draw {
 public:
  Draw(std::uint64_t seed, std::uint32_t stream)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32) ^ 0x5eed0005U},
        stream_(stream) {}

  // In (0, 1).
  double uniform() {
    if (used_ == 4) {
      block_ = philox(
          {static_cast<std::uint32_t>(counter_), static_cast<std::uint32_t>(counter_ >> 32), stream_, 0},
          key_);
      ++counter_;
      used_ = 0;
    }
    return (static_cast<double>(block_[used_++]) + 0.5) / 4294967296.0;
  }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform()); }
  bool chance(double probability) { return uniform() < probability; }
  int below(int count) { return static_cast<int>(uniform() * count); }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  double normal() {
    if (spare_) {
      spare_ = false;
      return second_;
    }
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    second_ = radius * std::sin(angle);
    spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  std::array<std::uint32_t, 2> key_;
  std::uint32_t stream_;
  std::uint64_t counter_ = 0;
  PhiloxBlock block_{};
  unsigned used_ = 4;
  bool spare_ = false;
  double second_ = 0.0;
};

}  // namespace ifog::undeclared
