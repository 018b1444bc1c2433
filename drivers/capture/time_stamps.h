// SPDX-License-Identifier: Apache-2.0
// Times that are large numbers, as seconds since 1970, without the loss of a digit. A double resolves such a
// second to 0.24 µs, and what is measured between two of them would be off by that. So where the first time
// of a text is that large, all of them are taken from a whole second before it, while they are still digits.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace ifog {

// Up to here the step between two doubles in s is good to half a ps, and times are as they stand.
inline constexpr double kFineTimes_s = 1024.0;

// The whole second from which times are to be counted that begin at so many ns.
[[nodiscard]] std::int64_t time_origin_s(std::int64_t first_ns);

// What the times of one column of a text are counted from.
class TimeStamps {
 public:
  TimeStamps() = default;
  // first: a time that is not after any other, which may be no number; unit_s: seconds in one.
  TimeStamps(std::string_view first, double unit_s);

  // So many in the text's unit since the origin, each within the rounding of one double: nothing but the
  // difference is rounded. False where the text is no number in plain digits, of which there may be other
  // ways to write one. `decimals` becomes the digits behind the point where that is more.
  [[nodiscard]] bool since(std::string_view text, double& value, int& decimals) const;
  // Of a time that was read otherwise.
  [[nodiscard]] double since(double absolute) const { return absolute - static_cast<double>(origin_); }
  [[nodiscard]] double absolute(double since) const { return since + static_cast<double>(origin_); }
  [[nodiscard]] std::int64_t origin_s() const { return origin_s_; }

 private:
  std::int64_t origin_ = 0;  // in the text's unit
  std::int64_t origin_s_ = 0;
};

// Decimals of a time that was written in no plain digits: any number of them.
inline constexpr int kAnyDecimals = std::numeric_limits<int>::max();

// Appends origin_s + since_s in decimal digits, exactly as many as tell since_s from other doubles.
void append_time(std::string& out, std::int64_t origin_s, double since_s);

// Steps between times that are whole ticks, each to the last bit of what the digits say.
class ExactSteps {
 public:
  ExactSteps() = default;  // times may lie anywhere
  // Of a column with so many decimals in units of unit_s.
  ExactSteps(int decimals, double unit_s);
  [[nodiscard]] double between(double before_s, double now_s) const;
  // The tick that a time is, which was rounded on its way.
  [[nodiscard]] double nearest(double time_s) const;

 private:
  [[nodiscard]] bool told_apart(double time_s) const;

  double ticks_per_s_ = 0.0;  // whole; 0: none
};

}  // namespace ifog
