// SPDX-License-Identifier: Apache-2.0
// Frames of a KVH 1750 in its format A, by the driver's own encoder, which its tests hold to the maker's manual.
#pragma once

#include <cstdint>
#include <functional>
#include <type_traits>
#include <vector>

#include "drivers/host/driver_instance.h"

namespace ifog {

inline constexpr std::size_t kFrame = 36;  // bytes

// Numbers of the samples `first` … `first + count - 1`: every axis has the rate of its number, rad/s, or of its number
// and its axis, and every channel the temperature.
template <typename Rate>
std::vector<std::uint8_t> kvh_frames(int first, int count, Rate&& rate_radps,
                                     const std::function<double(int)>& temperature_degC = {}) {
  DriverInstance driver = make_driver("kvh1750", {{"format", "a"}});
  std::vector<std::uint8_t> out;
  for (int n = first; n < first + count; ++n) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = static_cast<std::uint32_t>(n % 128);
    sample.valid_axes = 7;
    for (int axis = 0; axis < 3; ++axis)
      if constexpr (std::is_invocable_v<Rate, int, int>)
        sample.value[axis] = rate_radps(n, axis);
      else
        sample.value[axis] = rate_radps(n);
    for (double& value : sample.environment) value = temperature_degC ? temperature_degC(n) : 0.0;
    sample.environment_fresh = ~0U;
    driver.encode_bytes(sample, out);
  }
  return out;
}

}  // namespace ifog
