// SPDX-License-Identifier: Apache-2.0
// Events of the hot path as plain data; housekeeping makes the text.
#pragma once

#include <array>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <string>

#include "drivers/ifog/driver.h"
#include "drivers/transport/counter.h"

namespace ifog {

enum class EventKind : std::uint8_t {
  gap,               // count: missing samples, sequence: before this one
  device_restart,    // the device's counter or clock jumped back
  reopened,          // the device was closed and reopened
  overflow,          // the ring was full
  noise_learned,     // a: process noise, b: measurement noise, from the first rest
  model_in_use,      // sequence: first sample with the new parts
  divergence,        // the estimator restarted
  clock_step,        // the wall clock was set; a: its offset since start-up, s
  sensor_clock_set,  // the device's clock was set while it measured
  clock_refused,     // it is not used any more; a: its time per time of arrival
  label_moved,       // the device paused, or the delivery time changed: labels follow
  beyond_stated,     // a: first value outside the range stated in the format, b: its limit
  publish_failed,
};

struct Event {
  EventKind kind = EventKind::gap;
  std::uint64_t sequence = 0;
  std::uint64_t count = 0;
  double a = 0.0, b = 0.0;
  std::array<char, IFOG_NAME_LENGTH> name{};  // of the signal
};

// Text of one line, without the sensor's name.
std::string describe(const Event& event);

// From one thread of a pipeline to housekeeping.
class EventQueue {
 public:
  void report(const Event& event) noexcept {
    if (!ring_.push(event)) lost_.add(1);
  }
  bool take(Event& out) noexcept { return ring_.pop(out); }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_.value(); }

 private:
  boost::lockfree::spsc_queue<Event, boost::lockfree::capacity<256>> ring_;
  Counter lost_;
};

}  // namespace ifog
