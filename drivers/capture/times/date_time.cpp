// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/times/date_time.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "drivers/capture/times/text_cursor.h"
#include "drivers/ifog/decimal.h"

namespace ifog {
namespace {

// First three letters of an English month.
bool month_name(TextCursor& rest, int& value) {
  constexpr std::string_view kMonths = "JanFebMarAprMayJunJulAugSepOctNovDec";
  for (value = 1; value <= 12; ++value)
    if (rest.text(kMonths.substr(3 * static_cast<std::size_t>(value - 1), 3))) return true;
  return false;
}

// hh:mm, hh:mm:ss, hh:mm:ss.f… or hh:mm:ss:mmm, in twelve hours with AM or PM; mm:ss.f…, as spreadsheets show it
bool time_of_day(TextCursor& rest, bool seconds_needed, Decimal& time) {
  int hours = 0, minutes = 0, seconds = 0;
  if (!rest.number(1, 2, hours) || !rest.one_of(":_") || !rest.number(2, 2, minutes)) return false;
  bool seconds_given = rest.one_of(":_");
  if (!seconds_given && seconds_needed && (rest.at('.') || rest.at(','))) {
    seconds = std::exchange(minutes, std::exchange(hours, 0));
    seconds_given = true;
  } else if (seconds_given ? !rest.number(2, 2, seconds) : seconds_needed)
    return false;
  if (hours > 23 || minutes > 59 || seconds > 60) return false;
  std::optional<Decimal> fraction = Decimal{};
  const bool milliseconds = rest.at(':');  // all three digits: fewer of them are no fraction
  if (seconds_given && rest.one_of(".,:")) fraction = Decimal::parse("." + std::string(rest.digits()));
  if (!fraction || (milliseconds && fraction->decimals != 3)) return false;
  const bool after_noon = rest.text(" PM") || rest.text(" pm");
  if (after_noon || rest.text(" AM") || rest.text(" am")) {
    if (hours < 1 || hours > 12) return false;
    hours = hours % 12 + (after_noon ? 12 : 0);
  }
  time = {(time.value + (hours * 60 + minutes) * 60 + seconds) * ten_to(fraction->decimals) + fraction->value,
          fraction->decimals};
  return true;
}

std::optional<std::chrono::sys_days> valid_day(int year, int month, int day) {
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  return date.ok() ? std::optional(std::chrono::sys_days(date)) : std::nullopt;
}

// "2026-05-01", "2026/05/01", "1.5.2026" (day first), "5/1/2026", or "01-May-2026" (MATLAB).
std::optional<std::chrono::sys_days> day_of(TextCursor& rest, DateOrder order) {
  int first = 0, second = 0, third = 0;
  if (!rest.number(1, 4, first)) return std::nullopt;
  char between = '-';
  for (const char each : {'/', '.', '_'}) between = rest.at(each) ? each : between;
  if (!rest.literal(between)) return std::nullopt;
  const bool named = month_name(rest, second);
  if ((!named && !rest.number(1, 2, second)) || !rest.literal(between) || !rest.number(1, 4, third))
    return std::nullopt;
  if (first > 31) return between == '.' ? std::nullopt : valid_day(first, second, third);
  if (third < 1000 || (between == '-' && !named) || between == '_') return std::nullopt;
  const auto month_first = valid_day(third, first, second);
  if (between != '/' || order == DateOrder::day_first || (order == DateOrder::either && !month_first))
    return valid_day(third, second, first);
  return month_first;
}

// Offset of local time from UTC.
std::optional<std::int64_t> offset_s(TextCursor& rest) {
  rest.one_of(" ");
  if (rest.done() || rest.one_of("Zz") || rest.text("UTC")) return 0;
  const bool behind = rest.one_of("-");
  int hours = 0, minutes = 0;
  if ((!behind && !rest.one_of("+")) || !rest.number(2, 2, hours)) return std::nullopt;
  if (!rest.done() && ((rest.one_of(":"), !rest.number(2, 2, minutes)))) return std::nullopt;
  if (hours > 23 || minutes > 59) return std::nullopt;
  const std::int64_t by_s = (hours * 60 + minutes) * 60;
  return behind ? -by_s : by_s;
}

}  // namespace

std::optional<Decimal> Decimal::parse(std::string_view text, int most) {
  Decimal out;
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  const std::string_view behind = text.substr(std::min(point + 1, text.size()));
  if (point + behind.size() == 0 || point > 19 || std::ssize(behind) > most) return std::nullopt;
  for (const std::string_view digits : {text.substr(0, point), behind})
    for (const char c : digits) {
      if (c < '0' || c > '9') return std::nullopt;
      out.value = 10 * out.value + (c - '0');
    }
  if (negative) out.value = -out.value;
  out.decimals = static_cast<int>(behind.size());
  return out;
}

Int128 Decimal::with(int wanted) const {
  if (wanted >= decimals) return value * ten_to(wanted - decimals);
  const Int128 unit = ten_to(decimals - wanted);
  return value / unit - (value % unit < 0 ? 1 : 0);
}

double Decimal::in_double() const {
  return static_cast<double>(value) / static_cast<double>(ten_to(decimals));
}

Int128 ten_to(int exponent) {
  constexpr auto kPowers = [] {
    std::array<Int128, 38> powers{1};
    for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = 10 * powers[i - 1];
    return powers;
  }();
  return kPowers[static_cast<std::size_t>(exponent)];
}

std::optional<Decimal> date_time(std::string_view text, DateOrder order) {
  // Fast rejection of plain numbers: none has one of these near its beginning, or two points.
  const std::string_view begin = text.substr(0, 6);
  if (text.size() < 5 ||
      (begin.find_first_of(":/-_", 1) == std::string_view::npos && begin.find('.') == begin.rfind('.')))
    return std::nullopt;
  Decimal time;
  TextCursor rest(text);
  if (text[1] == ':' || text[2] == ':')
    return time_of_day(rest, true, time) && rest.done() ? std::optional(time) : std::nullopt;
  const auto day = day_of(rest, order);
  if (!day) return std::nullopt;
  time.value = std::chrono::sys_seconds(*day).time_since_epoch().count();
  if (rest.done()) return time;
  if (!rest.one_of("Tt _") || !time_of_day(rest, false, time)) return std::nullopt;
  const auto ahead_s = offset_s(rest);
  if (!ahead_s || !rest.done()) return std::nullopt;
  time.value -= *ahead_s * ten_to(time.decimals);
  return time;
}

std::optional<double> finite_number(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = read_decimal(text.data(), end, value);
  return error == std::errc() && at == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

char mark_of_thousands(std::string_view cell, char known) {
  const std::size_t first = cell.find_first_of(",.");
  const char mark = first < cell.size() ? cell[first] : '\0';
  const std::size_t last = cell.rfind(mark), other = cell.find(mark == ',' ? '.' : ',');
  if (mark != known && first == last && other == std::string_view::npos) return '\0';
  for (std::size_t at = first; at <= last && at < cell.size(); at += 4)
    if (cell[at] != mark || cell.substr(at + 1, 4).find_first_not_of("0123456789") < 3 ||
        at + 4 > cell.size())
      return '\0';
  return last < other ? mark : '\0';
}

PointDigits::PointDigits(std::string_view cell, Notation by) : digits_(cell) {
  const std::string_view typographic = "\xE2\x88\x92";
  const bool points = by.thousands == '.';
  if (cell.size() > made_.size() || (!points && cell.find_first_of(",Dd\xE2") == std::string_view::npos))
    return;
  char* end = made_.data();
  const char grouping = points || cell.find(',') < cell.size() ? mark_of_thousands(cell, by.thousands) : '\0';
  for (std::size_t i = 0; i < cell.size(); ++i) {
    if (grouping != '\0' && cell[i] == grouping) continue;
    const bool minus = cell.substr(i).starts_with(typographic);
    *end++ = minus                                ? '-'
             : cell[i] == ',' && by.decimal_comma ? '.'
             : cell[i] == 'D' || cell[i] == 'd'   ? 'E'
                                                  : cell[i];
    if (minus) i += typographic.size() - 1;
  }
  digits_ = {made_.data(), static_cast<std::size_t>(end - made_.data())};
}

}  // namespace ifog
