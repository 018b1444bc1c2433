// SPDX-License-Identifier: Apache-2.0
// What the hot path has to say, without formatting it: plain data that housekeeping words later.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "drivers/ifog/driver.h"

namespace ifog {

enum class EventKind : std::uint8_t {
  gap,               // count: samples missing, sequence: before this one
  device_restart,    // the device's counter or clock jumped back
  reopened,          // the device was closed and is open again
  overflow,          // the ring was full
  noise_learned,     // a: process noise, b: measurement noise, from the first rest
  model_in_use,      // sequence: the first sample with the new parts
  divergence,        // the estimator started again
  clock_step,        // the wall clock was set; a: how far it is now from where it was at start-up, s
  sensor_clock_set,  // the device's own clock was set while it measured on
  label_moved,       // the device stood still, or deliveries take another time: times of day follow
  beyond_stated,     // a: the first value beyond the range that the format's description states, b: its limit
  publish_failed,
};

struct Event {
  EventKind kind = EventKind::gap;
  std::int64_t utime_ns = 0;
  std::uint64_t sequence = 0;
  std::uint64_t count = 0;
  double a = 0.0, b = 0.0;
  std::array<char, IFOG_NAME_LENGTH> name{};  // of the signal
};

// One line for the log, without the sensor's name.
std::string describe(const Event& event);

}  // namespace ifog
