// SPDX-License-Identifier: Apache-2.0
// Processing of a delivery's increments: by the filter thread, or by the reader thread itself if the filter
// thread sleeps.
//
// Waking a thread costs more than all other work on a sample (a system call, leaving idle). So an idle filter
// thread stays asleep and the reader takes its place at the queue (figures in tests/bench/latency). The
// reader never waits for the filter thread: if that is awake, a delivery goes into the ring. A slow filter
// delays the reader by one delivery of a few samples at most. After two consecutive deliveries that took too
// long the filter thread does the work, each time for twice as long.
#pragma once

#include <cstddef>
#include <cstdint>

#include "daemon/pipeline/filter_stage.h"
#include "daemon/pipeline/increment_queue.h"
#include "drivers/transport/counter.h"

namespace ifog {

class HandOver {
 public:
  // direct: false leaves every step to the filter thread.
  HandOver(IncrementQueue& queue, FilterStage& filter, double nominal_rate_hz, bool direct);

  // For the reader thread, after each delivery.
  void delivered() noexcept;

  // For any thread: deliveries processed by the reader.
  [[nodiscard]] std::uint64_t done_here() const noexcept { return done_here_.value(); }

 private:
  IncrementQueue& queue_;
  FilterStage& filter_;
  const std::int64_t limit_ns_;
  const bool direct_;
  std::uint64_t left_to_filter_ = 0;  // number of further deliveries
  int too_long_in_a_row_ = 0;
  Counter done_here_;
};

}  // namespace ifog
