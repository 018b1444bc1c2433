// SPDX-License-Identifier: Apache-2.0
// Numbers and dates (ISO 8601, RFC 3339, …) in text as decimal numbers, without losing digits.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace ifog {

__extension__ typedef __int128 Int128;

// value / 10^decimals.
struct Decimal {
  Int128 value = 0;
  int decimals = 0;

  // Of plain digits, as in "-12.5", with at most 19 before the point and `most` behind it; nullopt otherwise.
  [[nodiscard]] static std::optional<Decimal> parse(std::string_view text, int most = 18);
  // The value with so many decimals; fewer ones are cut off, towards minus infinity.
  [[nodiscard]] Int128 with(int wanted) const;
  [[nodiscard]] double in_double() const;
};
[[nodiscard]] Int128 ten_to(int exponent);

// Of "5/1/2026". either: month first, if that is a date.
enum class DateOrder { either, month_first, day_first };

// Seconds since 1970 of "2026-05-01T12:00:00.25Z"; nullopt if the text is no date. Accepted: date and time or date
// alone; "/" or "_" for "-"; the year last, as in "1.5.2026" (day first) and "5/1/2026" (by `order`); month names
// as in "01-May-2026"; a space or "_" for "T"; "_" for ":"; AM or PM; missing seconds; a decimal comma or colon; offsets
// "+02:00", "+0200", "+02", "UTC" (default UTC). A time of day alone gives seconds since midnight. A leap second
// counts as the next second.
[[nodiscard]] std::optional<Decimal> date_time(std::string_view text, DateOrder order = DateOrder::either);
[[nodiscard]] inline bool is_date(std::string_view text) { return date_time(text).has_value(); }

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

 private:
  std::array<char, 64> made_;
  std::string_view digits_;
};

}  // namespace ifog
