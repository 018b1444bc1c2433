// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/hand_over.h"

#include <algorithm>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

// Increments that the reader processes at once. A serial adapter that collects for 1 ms brings five at 5 kHz;
// a recording brings hundreds, which use two processors.
constexpr std::size_t kMost = 8;

// Share of a delivery's time for the filter; the rest is for reading the next one.
constexpr double kShare = 0.5;

// Deliveries left to the filter thread after two that took too long: initially, and the largest number of
// doublings.
constexpr std::uint64_t kShortestPause = 16;
constexpr int kDoublings = 8;

}  // namespace

HandOver::HandOver(IncrementQueue& queue, FilterStage& filter, double nominal_rate_hz, bool direct)
    : queue_(queue),
      filter_(filter),
      limit_ns_(static_cast<std::int64_t>(kShare * 1e9 / nominal_rate_hz)),
      direct_(direct) {}

void HandOver::delivered() noexcept {
  if (left_to_filter_ > 0) --left_to_filter_;
  if (!direct_ || left_to_filter_ > 0) {
    queue_.flush();
    return;
  }
  if (!queue_.flush_or_borrow(kMost)) return;
  const std::int64_t from_ns = monotonic_ns();
  std::int64_t steps = 0;
  while (filter_.step()) ++steps;
  const bool slow = monotonic_ns() - from_ns > std::max<std::int64_t>(steps, 1) * limit_ns_;
  queue_.give_back();
  if (steps == 0) return;
  done_here_.add(1);
  if (!slow) {
    too_long_in_a_row_ = 0;
    return;
  }
  if (too_long_in_a_row_ > 0)
    left_to_filter_ = kShortestPause << std::min(too_long_in_a_row_ - 1, kDoublings);
  ++too_long_in_a_row_;
}

}  // namespace ifog
