// SPDX-License-Identifier: Apache-2.0
// Arithmetic with nanoseconds of any value, without undefined overflow.
#pragma once

#include <cstdint>
#include <limits>

namespace ifog {

// Difference; wraps on overflow, which then looks like a clock jump.
inline std::int64_t ns_between(std::int64_t from_ns, std::int64_t to_ns) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(to_ns) - static_cast<std::uint64_t>(from_ns));
}
// Sum; saturates on overflow.
inline std::int64_t ns_after(std::int64_t time_ns, std::int64_t by_ns) noexcept {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min(),
                         kMost = std::numeric_limits<std::int64_t>::max();
  if (by_ns > 0 && time_ns > kMost - by_ns) return kMost;
  if (by_ns < 0 && time_ns < kLeast - by_ns) return kLeast;
  return time_ns + by_ns;
}

}  // namespace ifog
