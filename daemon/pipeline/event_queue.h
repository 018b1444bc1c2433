// SPDX-License-Identifier: Apache-2.0
// Ring of events from the hot path.
#pragma once

#include <cstdint>

#include "daemon/health/event.h"
#include "daemon/pipeline/ring.h"
#include "drivers/transport/counter.h"

namespace ifog {

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
