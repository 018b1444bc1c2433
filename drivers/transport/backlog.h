// SPDX-License-Identifier: Apache-2.0
// Whether the time of reading is a time of arrival.
//
// A process that was delayed (stopped, starved, asleep with its machine) finds all that arrived meanwhile at
// once. Taking the time of reading for the time of arrival would make a silence of what was only read late,
// and lost samples of those still to come. So from a read that was left or entered late until all that had
// piled up is through, arrival times are not known.
#pragma once

#include <cstdint>

namespace ifog {

class Backlog {
 public:
  // One read: when it was entered and left, and how long it was to wait at most. True: what it brought may
  // have come at any time.
  bool read(std::int64_t entered_ns, std::int64_t left_ns, std::int64_t timeout_ns) noexcept {
    const bool late = left_ns - entered_ns > timeout_ns + kHeldUp_ns ||
                      (left_ns_ != 0 && entered_ns - left_ns_ > kHeldUp_ns);
    left_ns_ = left_ns;
    if (late) until_ns_ = left_ns + kPiled_ns;
    return until_ns_ != 0;
  }
  // It may be over, if nothing more waits to be read.
  [[nodiscard]] bool may_be_over() const noexcept { return left_ns_ > until_ns_; }
  void over() noexcept { until_ns_ = 0; }

 private:
  static constexpr std::int64_t kHeldUp_ns = 50'000'000;
  // The kernel hands on from buffer to buffer: a look that finds nothing just after the first reading says
  // little.
  static constexpr std::int64_t kPiled_ns = 100'000'000;
  std::int64_t left_ns_ = 0, until_ns_ = 0;
};

}  // namespace ifog
