// SPDX-License-Identifier: Apache-2.0
// Rates and specific force of a sample that has all of them, for messages that have no place for a flag.
#pragma once

#include <cmath>
#include <cstddef>

#include "filters/chain/signal_chain.h"

namespace ifog {

struct WholeSample {
  Axes rate_radps{}, specific_force_mps2{};  // means over the sample
};

// False: one of them is not known. Specific force that comes less often than rates is that of the last frame
// that had it.
inline bool whole_sample(const Increment& in, const ChainOutput& out, const SensorFacts& facts,
                         WholeSample& sample) noexcept {
  for (std::size_t i = 0; i < kMaxAxes; ++i) {
    if (!(in.covered_s[i] > 0.0) || facts.acceleration_channel[i] < 0) return false;
    sample.rate_radps[i] = out.delta_theta_rad[i] / in.covered_s[i];
    sample.specific_force_mps2[i] = in.moved_s[i] > 0.0
                                        ? in.delta_v_mps[i] / in.moved_s[i]
                                        : in.channel[static_cast<std::size_t>(facts.acceleration_channel[i])];
    if (!std::isfinite(sample.rate_radps[i]) || !std::isfinite(sample.specific_force_mps2[i])) return false;
  }
  return true;
}

}  // namespace ifog
