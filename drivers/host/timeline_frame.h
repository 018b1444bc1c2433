// SPDX-License-Identifier: Apache-2.0
// What of a driver's sample its place in time is told by.
#pragma once

#include <cstddef>

#include "drivers/ifog/device_timeline.h"
#include "drivers/ifog/driver.h"

namespace ifog {

// Points into the sample.
inline DeviceTimeline::Frame timeline_frame(const ifog_sample& sample, std::size_t axes) noexcept {
  DeviceTimeline::Frame frame;
  frame.counts = (sample.flags & IFOG_SAMPLE_SEQUENCE) != 0;
  frame.sequence = sample.sequence;
  frame.clocked = (sample.flags & IFOG_SAMPLE_DEVICE_TIME) != 0;
  frame.stamp = {sample.device_time_ns, sample.device_wrap_ns};
  frame.arrival_ns = sample.arrival_ns;
  frame.values = {sample.value, axes};
  return frame;
}

}  // namespace ifog
