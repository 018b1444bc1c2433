// SPDX-License-Identifier: Apache-2.0
// Times that are large numbers, as seconds since 1970, without the loss of a digit. A double resolves such a
// second to 0.24 µs, and what is measured between two of them would be off by that. So where the first time
// is that large, all are counted from it while they are still digits: the series has the bits of one that
// begins at 0.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/capture/times/date_time.h"

namespace ifog {

// Up to here the step between two doubles in s is good to half a ps, and times are as they stand.
inline constexpr double kFineTimes_s = 1024.0;

// What times are counted from: s + ns / 10^9, ns being 0 … 999999999.
struct TimeOrigin {
  std::int64_t s = 0;
  std::int64_t ns = 0;

  // From which times are to be counted that begin at so many ns; 0 for small ones.
  [[nodiscard]] static TimeOrigin of(std::int64_t first_ns);

  // A time as a double holds it.
  [[nodiscard]] double in_s(double since_s) const {
    return static_cast<double>(s) + (static_cast<double>(ns) / 1e9 + since_s);
  }
  // What 64 bits have room for.
  [[nodiscard]] std::int64_t in_ns(double since_s) const {
    // Modulo 2^64, as the whole second may lie below what has room.
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(s) * 1'000'000'000U +
                                     static_cast<std::uint64_t>(ns) +
                                     static_cast<std::uint64_t>(std::llround(since_s * 1e9)));
  }
  // By how much this is later.
  [[nodiscard]] double later_than(const TimeOrigin& other) const {
    return static_cast<double>(s - other.s) + static_cast<double>(ns - other.ns) / 1e9;
  }
  bool operator==(const TimeOrigin&) const = default;
};

// A time as text says it, of which no digit is lost: a whole second and what is beyond it.
struct SaidTime {
  double whole_s = 0.0, beyond_s = 0.0;

  // Parses any decimal number or date; nullopt for what is neither, or not finite.
  [[nodiscard]] static std::optional<SaidTime> parse(std::string_view text);
  // Whether a time is before this one, by half a ns or more.
  [[nodiscard]] bool is_after(const TimeOrigin& origin, double since_s) const {
    const double later = (static_cast<double>(origin.s) - whole_s) +
                         (static_cast<double>(origin.ns) / 1e9 - beyond_s + since_s);
    return later <= -0.5e-9;
  }
};

// What the times of one column of a text are counted from.
class TimeStamps {
 public:
  TimeStamps() = default;
  // first: a time that is not after any other, which may be no number; unit_s: seconds in one.
  TimeStamps(std::string_view first, double unit_s);

  // Seconds since the origin, each within the rounding of one double: nothing but the
  // difference is rounded. False where the text is no number in plain digits, of which there may be other
  // ways to write one.
  [[nodiscard]] bool since(std::string_view text, double& value) const;
  // The same for a time that was read otherwise.
  [[nodiscard]] double since(double absolute) const;
  [[nodiscard]] TimeOrigin origin() const { return origin_; }

 private:
  [[nodiscard]] double seconds(double value, double parts_of_unit) const;

  double unit_s_ = 1.0;
  std::int64_t units_a_second_ = 1;  // 0: no whole number
  // In the text's unit: whole_ + fraction_ / 10^decimals_.
  std::int64_t whole_ = 0, fraction_ = 0;
  int decimals_ = 0;
  TimeOrigin origin_;
};

// Appends the time in decimal digits, exactly as many as tell since_s from other doubles.
void append_time(std::string& out, const TimeOrigin& origin, double since_s);

}  // namespace ifog
