// SPDX-License-Identifier: Apache-2.0
// The environment channels of a sample, held from the frames that bring them to those that do not; and
// numbers on their way into a frame.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "ifog/driver.h"

namespace ifog::framing {

class Channels {
 public:
  Channels() { held_.fill(std::numeric_limits<double>::quiet_NaN()); }
  // A new value, which came with this sample. What is not finite is none.
  void set(ifog_sample& sample, std::size_t channel, double value) noexcept {
    if (!std::isfinite(value)) return;
    held_[channel] = value;
    sample.environment_fresh |= 1U << channel;
  }
  void copy_to(ifog_sample& sample) const noexcept {
    std::copy(held_.begin(), held_.end(), sample.environment);
  }

 private:
  std::array<double, IFOG_MAX_ENVIRONMENT> held_{};
};

}  // namespace ifog::framing
