// SPDX-License-Identifier: Apache-2.0
// Times of attempts to reopen a device: at once, then at growing intervals of at most 100 ms, so that a
// returning device is used within a second.
#pragma once

#include <algorithm>
#include <cstdint>

namespace ifog {

class Backoff {
 public:
  static constexpr std::int64_t kFirst_ns = 10'000'000, kLongest_ns = 100'000'000;

  // The device disappeared at `now_ns`.
  void restart(std::int64_t now_ns) {
    pause_ns_ = kFirst_ns;
    next_ns_ = now_ns;
  }
  // An attempt at `now_ns` failed.
  void failed(std::int64_t now_ns) {
    next_ns_ = now_ns + pause_ns_;
    pause_ns_ = std::min(2 * pause_ns_, kLongest_ns);
  }
  [[nodiscard]] std::int64_t next_ns() const { return next_ns_; }

 private:
  std::int64_t pause_ns_ = kFirst_ns, next_ns_ = 0;
};

}  // namespace ifog
