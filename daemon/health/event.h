// What the hot path has to say, without formatting it: plain data through a ring, drained and worded by
// housekeeping.
#pragma once

#include <cstdint>
#include <string>

#include "daemon/health/counter.h"
#include "daemon/pipeline/ring.h"

namespace ifog {

enum class EventKind : std::uint8_t {
  gap,             // count: samples missing, sequence: before this one
  device_restart,  // the device's counter or clock jumped back
  reopened,        // the device was closed and is open again
  overflow,        // the ring was full
  noise_learned,   // a: process noise, b: measurement noise, from start-up data
  model_in_use,    // sequence: the first sample with the new parts
  divergence,      // the estimator started again
  clock_step,      // the wall clock was set; a: how far it is now from where it was at start-up, s
  publish_failed,
};

struct Event {
  EventKind kind = EventKind::gap;
  std::int64_t utime_ns = 0;
  std::uint64_t sequence = 0;
  std::uint64_t count = 0;
  double a = 0.0, b = 0.0;
};

// One line for the log, without the sensor's name.
std::string describe(const Event& event);

// From one thread of a pipeline to housekeeping.
class EventQueue {
 public:
  EventQueue() : ring_(256) {}
  void report(const Event& event) noexcept {
    Event* const slot = ring_.claim();
    if (slot == nullptr) {
      lost_.add(1);
      return;
    }
    *slot = event;
    ring_.commit();
  }
  bool take(Event& out) noexcept {
    const Event* const event = ring_.front();
    if (event == nullptr) return false;
    out = *event;
    ring_.pop();
    return true;
  }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_.value(); }

 private:
  Ring<Event> ring_;
  Counter lost_;
};

}  // namespace ifog
