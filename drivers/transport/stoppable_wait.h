// SPDX-License-Identifier: Apache-2.0
// Waits for a descriptor until a deadline, or until another thread or a signal handler stops it.
#pragma once

#include <atomic>
#include <cstdint>

#include "drivers/system/fd.h"

namespace ifog {

class StoppableWait {
 public:
  // Throws std::runtime_error if no timerfd is available.
  StoppableWait();

  // Ends the present wait and all later ones.
  void stop() noexcept;
  [[nodiscard]] bool stopped() const { return stopped_.load(); }

  enum class Wake { ready, timeout, stopped };
  // Waits for `events` on fd (only for time and stop() if fd is −1), until `until_ns` of CLOCK_MONOTONIC.
  // `happened`, unless null, gets poll's result.
  Wake wait(int fd, short events, std::int64_t until_ns, short* happened = nullptr) noexcept;
  // True if data wait there now, unless stopped.
  [[nodiscard]] bool is_readable(int fd) noexcept;

 private:
  // Ends a wait at alarm_ns_, and at once after stop(). A deadline of poll() itself is a timer that every read sets
  // anew, which costs more than the read; with steady traffic this one is set once per deadline.
  Fd alarm_;
  std::int64_t alarm_ns_ = INT64_MAX;  // not set
  // Sequentially consistent with the alarm: either stop() rings last, or the wait sees the flag.
  std::atomic<bool> stopped_{false};
};

}  // namespace ifog
