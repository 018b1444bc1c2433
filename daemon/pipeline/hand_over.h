// SPDX-License-Identifier: Apache-2.0
// What becomes of the increments of a delivery: the filter thread takes them, or, when it sleeps, the reader
// thread does its step itself.
//
// Waking a thread costs more than everything else that is done with a sample: a system call on one processor,
// the way out of idle on another. An idle filter thread therefore stays asleep, and the reader takes its
// place at the queue for as long as it has brought something (tests/bench/latency has the figures). What was
// promised stays true: a delivery finds the filter thread asleep or goes into the ring, the reader never
// waits for it, and a filter that is too slow cannot hold the reader up for longer than one delivery of a few
// samples. Two in a row that took too much of a sample's time (one may be the machine's doing), and the
// filter thread does the work again, for twice as long each further time.
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

  // Reader thread, after each delivery.
  void delivered() noexcept;

  // Any thread may read them: deliveries whose steps the reader has done, and those of them that took it too
  // long.
  [[nodiscard]] std::uint64_t done_here() const noexcept { return done_here_.value(); }
  [[nodiscard]] std::uint64_t too_long() const noexcept { return too_long_.value(); }

 private:
  IncrementQueue& queue_;
  FilterStage& filter_;
  const std::int64_t limit_ns_;
  const bool direct_;
  std::uint64_t left_to_filter_ = 0;  // so many deliveries more
  int too_long_in_a_row_ = 0;
  Counter done_here_, too_long_;
};

}  // namespace ifog
