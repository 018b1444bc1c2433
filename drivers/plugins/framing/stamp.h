// SPDX-License-Identifier: Apache-2.0
// A device's time stamp: a count of ticks, as it is sent.
#pragma once

#include <cstdint>

namespace ifog::framing {

class Stamp {
 public:
  // Of so many nanoseconds a tick.
  explicit constexpr Stamp(std::int64_t tick_ns) : tick_ns_(tick_ns) {}
  [[nodiscard]] constexpr std::int64_t time_ns(std::int64_t ticks) const noexcept { return ticks * tick_ns_; }
  // The inverse: the stamp a device sends at this time, where that goes round after `modulus` ticks. Times
  // before the origin stay in order.
  [[nodiscard]] std::uint32_t stamp_at(std::int64_t time_ns, std::int64_t modulus) const noexcept {
    const std::int64_t ticks = time_ns / tick_ns_ - (time_ns % tick_ns_ < 0 ? 1 : 0);
    const std::int64_t stamp = ticks % modulus;
    return static_cast<std::uint32_t>(stamp < 0 ? stamp + modulus : stamp);
  }

 private:
  std::int64_t tick_ns_;
};

}  // namespace ifog::framing
