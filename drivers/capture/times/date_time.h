// SPDX-License-Identifier: Apache-2.0
// Converts dates (ISO 8601, RFC 3339, …) to decimal digits of seconds, which are parsed as numbers without
// losing digits.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace ifog {

inline constexpr std::size_t kLongestDate = 64;

// Of "5/1/2026". either: month first, if that is a date.
enum class DateOrder { either, month_first, day_first };

// Seconds since 1970 of "2026-05-01T12:00:00.25Z" as digits in `to`; empty if the text is no date. Accepted:
// date and time or date alone; "/" or "_" for "-"; the year last, as in "1.5.2026" (day first) and "5/1/2026"
// (by `order`); month names as in "01-May-2026"; a space or "_" for "T"; "_" for ":"; AM or PM; missing
// seconds; a decimal comma; offsets "+02:00", "+0200", "+02", "UTC" (default UTC). A time of day alone gives
// seconds since midnight. A leap second counts as the next second.
std::string_view date_in_digits(std::string_view text, std::span<char, kLongestDate> to,
                                DateOrder order = DateOrder::either);

[[nodiscard]] inline bool is_date(std::string_view text) {
  std::array<char, kLongestDate> digits;
  return !date_in_digits(text, digits).empty();
}

// The number if the whole text is a finite number; else nullopt.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);

// How a table writes numbers. thousands: the mark between groups of three digits, if a cell has shown it; else 0.
struct Notation {
  bool decimal_comma = false;
  char thousands = '\0';
};

// The mark between groups of three digits, "," in "1,234.5" and "." in "1.234,5"; 0 if there is none, or it may be the
// decimal mark and is not `known`.
char mark_of_thousands(std::string_view cell, char known);

// Cell with a decimal point instead of a comma, without marks of thousands ("1,234.5"), with an ASCII minus sign, and E
// for the exponent's D of Fortran.
class PointDigits {
 public:
  PointDigits(std::string_view cell, Notation by);
  PointDigits(const PointDigits&) = delete;
  PointDigits& operator=(const PointDigits&) = delete;
  operator std::string_view() const { return digits_; }

 protected:
  std::array<char, kLongestDate> made_;
  std::string_view digits_;
};

// Cell of a time: digits of a date or of a number.
class TimeDigits : public PointDigits {
 public:
  TimeDigits(std::string_view cell, Notation by, DateOrder order = DateOrder::either);
  [[nodiscard]] bool is_date() const { return date_; }

 private:
  bool date_ = false;
};

}  // namespace ifog
