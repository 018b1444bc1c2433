// SPDX-License-Identifier: Apache-2.0
// The frames that came last: whether one that seems to come from before was among them, has another's place,
// or is the one that is missing there.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/ifog/arrivals.h"

namespace ifog {

// Of the values of a sample, NaN by its bits: two that differ have, but for one in 2^64, another.
inline std::uint64_t digest_of(std::span<const double> values) noexcept {
  std::uint64_t out = 0x9E3779B97F4A7C15U;
  for (const double value : values) {
    out = (out ^ std::bit_cast<std::uint64_t>(value)) * 0xD6E8FEB86659FD93U;
    out ^= out >> 32U;
  }
  return out;
}

class RecentFrames {
 public:
  static constexpr std::uint64_t kKept = 64, kEnough = 16;
  enum class Had : std::uint8_t {
    no,     // none was there
    other,  // one was, with other values
    same
  };

  void forget() noexcept { came_ = 0; }
  // place: the counter, unwrapped; time_ns: the device's; each where it has one.
  void add(std::uint64_t place, std::int64_t time_ns, std::uint64_t digest) noexcept {
    kept_[came_++ % kKept] = {place, time_ns, digest};
  }
  // No two of them have the same values, and they are enough for that to say something: what has the values
  // of one is that one. A sensor of coarse steps measures the same again and again.
  [[nodiscard]] bool tells_values_apart() const noexcept {
    const std::span<const Kept> all = kept();
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (all[i].digest == all[j].digest) return false;
    return all.size() >= kEnough;
  }
  [[nodiscard]] Had at_place(std::uint64_t place, std::uint64_t digest) const noexcept {
    Had had = Had::no;
    for (const Kept& one : kept())
      if (one.place == place) had = std::max(had, one.digest == digest ? Had::same : Had::other);
    return had;
  }
  // other: of a time that is nearer than this, but for what has the very values.
  [[nodiscard]] Had at_time(std::int64_t time_ns, std::int64_t near_ns, std::uint64_t digest) const noexcept {
    Had had = Had::no;
    for (const Kept& one : kept()) {
      const std::int64_t apart = ns_between(time_ns, one.time_ns);
      if (-near_ns <= apart && apart <= near_ns)
        had = std::max(had, apart == 0 && one.digest == digest ? Had::same : Had::other);
    }
    return had;
  }

 private:
  struct Kept {
    std::uint64_t place;
    std::int64_t time_ns;
    std::uint64_t digest;
  };
  [[nodiscard]] std::span<const Kept> kept() const noexcept {
    return std::span(kept_).first(static_cast<std::size_t>(std::min(came_, kKept)));
  }

  std::array<Kept, kKept> kept_{};
  std::uint64_t came_ = 0;
};

}  // namespace ifog
