// SPDX-License-Identifier: Apache-2.0
// The latest value of an environment channel that does not come in the sensor's frames, and how old it is.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

namespace ifog {

struct ChannelValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::int64_t time_ns = 0;  // of the measurement, arrival clock; 0: none came yet

  // Of a sample that came at `now_ns`; infinite until the first value, never negative.
  [[nodiscard]] float age_s(std::int64_t now_ns) const noexcept {
    if (time_ns == 0) return std::numeric_limits<float>::infinity();
    return std::max(0.0F, static_cast<float>(now_ns - time_ns) * 1e-9F);
  }
  // To the bit, so that "no value" is the same as itself.
  [[nodiscard]] bool same(const ChannelValue& other) const noexcept {
    return time_ns == other.time_ns &&
           std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(other.value);
  }
};

}  // namespace ifog
