// SPDX-License-Identifier: Apache-2.0
// When to try again to open a device that is gone: at once, then ever less often, but often enough that a
// device that comes back is in use again well within a second.
#pragma once

#include <algorithm>
#include <cstdint>

namespace ifog {

class Backoff {
 public:
  static constexpr std::int64_t kFirst_ns = 10'000'000, kLongest_ns = 100'000'000;

  // The device went away at `now_ns`.
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
