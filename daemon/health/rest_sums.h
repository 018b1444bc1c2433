// SPDX-License-Identifier: Apache-2.0
// Sums over samples at rest for the tests of noise and bias, updated by the hot path. They only grow; readers
// use differences.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

struct RestSums {
  struct Axis {
    double samples = 0.0, rate = 0.0;      // compensated, rad/s
    double square = 0.0;                   // of innovations, (rad/s)^2
    double pairs = 0.0, product = 0.0;     // of neighbouring innovations
    double moved = 0.0, moved_rate = 0.0;  // number and sum of rates of samples not at rest
  };
  std::array<Axis, kMaxAxes> axis{};

  // at_rest: all axes are. No allocation, no lock.
  void add(std::size_t a, bool at_rest, double rate_radps, double innovation_radps) noexcept {
    Axis& sums = axis[a];
    if (!at_rest) {
      sums.moved += 1.0;
      sums.moved_rate += rate_radps;
      last_known_[a] = false;
      return;
    }
    sums.samples += 1.0;
    sums.rate += rate_radps;
    sums.square += innovation_radps * innovation_radps;
    if (last_known_[a]) {
      sums.pairs += 1.0;
      sums.product += innovation_radps * last_[a];
    }
    last_[a] = innovation_radps;
    last_known_[a] = true;
  }
  // The next value does not follow the last one.
  void break_off(std::size_t a) noexcept { last_known_[a] = false; }

 private:
  std::array<double, kMaxAxes> last_{};
  std::array<bool, kMaxAxes> last_known_{};
};

}  // namespace ifog
