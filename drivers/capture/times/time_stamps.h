// SPDX-License-Identifier: Apache-2.0
// Large times, such as seconds since 1970, without loss of digits. A double resolves them only to 0.24 µs. So
// if the first time is large, all are taken relative to it as digits, and the series has the same bits as one
// that starts at 0.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/capture/times/date_time.h"

namespace ifog {

// Up to here doubles in s resolve 0.5 ps, and times are used unchanged.
inline constexpr double kFineTimes_s = 1024.0;

// Origin of times: s + ns / 10^9, ns in 0 … 999999999.
struct TimeOrigin {
  std::int64_t s = 0;
  std::int64_t ns = 0;

  // Origin for times that start at first_ns; 0 for small ones.
  [[nodiscard]] static TimeOrigin of(std::int64_t first_ns);

  // Absolute time as a double.
  [[nodiscard]] double in_s(double since_s) const {
    return static_cast<double>(s) + (static_cast<double>(ns) / 1e9 + since_s);
  }
  // In 64 bits.
  [[nodiscard]] std::int64_t in_ns(double since_s) const {
    // Modulo 2^64, because the seconds alone may be out of range.
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(s) * 1'000'000'000U +
                                     static_cast<std::uint64_t>(ns) +
                                     static_cast<std::uint64_t>(std::llround(since_s * 1e9)));
  }
  // Difference to an earlier origin.
  [[nodiscard]] double later_than(const TimeOrigin& other) const {
    return static_cast<double>(s - other.s) + static_cast<double>(ns - other.ns) / 1e9;
  }
  bool operator==(const TimeOrigin&) const = default;
};

// Time from a text without loss of digits: whole seconds and the rest.
struct SaidTime {
  double whole_s = 0.0, beyond_s = 0.0;

  // Parses any decimal number or date; nullopt otherwise or if not finite.
  [[nodiscard]] static std::optional<SaidTime> parse(std::string_view text);
  // True if a time is before this one by 0.5 ns or more.
  [[nodiscard]] bool is_after(const TimeOrigin& origin, double since_s) const {
    const double later = (static_cast<double>(origin.s) - whole_s) +
                         (static_cast<double>(origin.ns) / 1e9 - beyond_s + since_s);
    return later <= -0.5e-9;
  }
};

// Conversion of one column's time stamps.
class TimeStamps {
 public:
  TimeStamps() = default;
  // first: a time that is not after any other. unit_s: seconds per unit.
  TimeStamps(std::optional<Decimal> first, double unit_s);

  // Seconds since the origin, rounded once; nullopt if a double of the text is rounded less.
  [[nodiscard]] std::optional<double> since(const Decimal& time) const;
  // The same for a double.
  [[nodiscard]] double since(double absolute) const;
  [[nodiscard]] TimeOrigin origin() const { return origin_; }

 private:
  [[nodiscard]] double seconds(double value, double parts_of_unit) const;

  double unit_s_ = 1.0;
  std::int64_t units_a_second_ = 1;  // 0: not a whole number
  Decimal base_;                     // the origin, in the text's unit
  TimeOrigin origin_;
};

// Appends the time in as many decimal digits as identify since_s.
void append_time(std::string& out, const TimeOrigin& origin, double since_s);

}  // namespace ifog
