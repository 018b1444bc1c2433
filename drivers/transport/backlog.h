// SPDX-License-Identifier: Apache-2.0
// Decides if the time of a read is an arrival time.
//
// A process that was delayed (stopped, starved, asleep with its computer) reads everything that arrived
// meanwhile at once. If the read time were used as arrival time, late reads would look like a silence, and
// later samples like losses. So after a read that was entered or left late, arrival times are unknown until
// the backlog is read.
#pragma once

#include <cstdint>

namespace ifog {

class Backlog {
 public:
  // Reports one read: entry, end and timeout. True: its data may have arrived at any time.
  bool read(std::int64_t entered_ns, std::int64_t left_ns, std::int64_t timeout_ns) noexcept {
    const bool late = left_ns - entered_ns > timeout_ns + kDelayed_ns ||
                      (left_ns_ != 0 && entered_ns - left_ns_ > kDelayed_ns);
    left_ns_ = left_ns;
    if (late) until_ns_ = left_ns + kPiled_ns;
    return until_ns_ != 0;
  }
  // True if the backlog may be read completely, provided that nothing more waits.
  [[nodiscard]] bool may_be_over() const noexcept { return left_ns_ > until_ns_; }
  void over() noexcept { until_ns_ = 0; }

 private:
  static constexpr std::int64_t kDelayed_ns = 50'000'000;
  // The kernel passes data between buffers, so an empty read soon after the first is not conclusive.
  static constexpr std::int64_t kPiled_ns = 100'000'000;
  std::int64_t left_ns_ = 0, until_ns_ = 0;
};

}  // namespace ifog
