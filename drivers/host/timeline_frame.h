// SPDX-License-Identifier: Apache-2.0
// Part of a driver's sample that determines its time.
#pragma once

#include <cstddef>

#include "drivers/ifog/driver.h"
#include "drivers/timeline/timeline.h"

namespace ifog {

// Refers to the sample.
inline Timeline::Frame timeline_frame(const ifog_sample& sample, std::size_t axes) noexcept {
  Timeline::Frame frame;
  frame.counts = (sample.flags & IFOG_SAMPLE_SEQUENCE) != 0;
  frame.sequence = sample.sequence;
  frame.clocked = (sample.flags & IFOG_SAMPLE_DEVICE_TIME) != 0;
  frame.stamp_ns = sample.device_time_ns;
  frame.wrap_ns = sample.device_wrap_ns;
  frame.arrival_ns = sample.arrival_ns;
  frame.at_once = sample.at_once;
  frame.values = {sample.value, axes};
  return frame;
}

}  // namespace ifog
