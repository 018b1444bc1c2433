// SPDX-License-Identifier: Apache-2.0
// Times that loggers write as dates (ISO 8601, RFC 3339), as the decimal digits of a number of seconds: what
// reads numbers reads them then, with every digit that stood there.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace ifog {

inline constexpr std::size_t kLongestDate = 64;

// Of "5/1/2026". either: the month first, where that is a date.
enum class DateOrder { either, month_first, day_first };

// The seconds since 1970 of "2026-05-01T12:00:00.25Z": date and time of day, or a day alone; "/" or "_" for
// "-", the year last as in "1.5.2026" (the day first) and "5/1/2026" (in that order), a
// month's name as in "01-May-2026", a space or "_" for "T", "_" for ":", AM or PM, seconds missing, a comma for
// the point, an offset of "+02:00", "+0200", "+02", "UTC"; without one it is UTC. Of a time of day alone,
// "12:00:00.25", those since midnight. A leap second is the second behind it. `to` takes the digits; the text is
// empty for what is no such date.
std::string_view date_in_digits(std::string_view text, std::span<char, kLongestDate> to,
                                DateOrder order = DateOrder::either);

[[nodiscard]] inline bool is_date(std::string_view text) {
  std::array<char, kLongestDate> digits;
  return !date_in_digits(text, digits).empty();
}

// The finite number that all of a text is; nothing for any other text.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);

// What a cell says, a decimal comma as a point.
class PointDigits {
 public:
  PointDigits(std::string_view cell, bool decimal_comma);
  PointDigits(const PointDigits&) = delete;
  PointDigits& operator=(const PointDigits&) = delete;
  operator std::string_view() const { return digits_; }

 protected:
  std::array<char, kLongestDate> made_;
  std::string_view digits_;
};

// A cell of a time: the digits of a date, or of a number.
class TimeDigits : public PointDigits {
 public:
  TimeDigits(std::string_view cell, bool decimal_comma, DateOrder order = DateOrder::either);
  [[nodiscard]] bool is_date() const { return date_; }

 private:
  bool date_ = false;
};

}  // namespace ifog
