// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/times/date_time.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
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

struct Moment {
  std::int64_t s = 0;
  std::string_view fraction;  // decimal digits
};

// hh:mm, hh:mm:ss or hh:mm:ss.f…, in twelve hours with AM or PM; mm:ss.f…, as spreadsheets show it
bool time_of_day(TextCursor& rest, bool seconds_needed, Moment& moment) {
  int hours = 0, minutes = 0, seconds = 0;
  if (!rest.number(1, 2, hours) || !rest.one_of(":_") || !rest.number(2, 2, minutes)) return false;
  bool seconds_given = rest.one_of(":_");
  if (!seconds_given && seconds_needed && (rest.at('.') || rest.at(','))) {
    seconds = std::exchange(minutes, std::exchange(hours, 0));
    seconds_given = true;
  } else if (seconds_given ? !rest.number(2, 2, seconds) : seconds_needed)
    return false;
  if (hours > 23 || minutes > 59 || seconds > 60) return false;
  if (seconds_given && rest.one_of(".,")) {
    moment.fraction = rest.digits();
    if (moment.fraction.empty()) return false;
  }
  const bool after_noon = rest.text(" PM") || rest.text(" pm");
  if (after_noon || rest.text(" AM") || rest.text(" am")) {
    if (hours < 1 || hours > 12) return false;
    hours = hours % 12 + (after_noon ? 12 : 0);
  }
  moment.s += (hours * 60 + minutes) * 60 + seconds;
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

std::optional<Moment> moment_of(std::string_view text, DateOrder order) {
  Moment moment;
  TextCursor rest(text);
  if (text.size() > 2 && (text[1] == ':' || text[2] == ':'))
    return time_of_day(rest, true, moment) && rest.done() ? std::optional(moment) : std::nullopt;
  const auto day = day_of(rest, order);
  if (!day) return std::nullopt;
  moment.s = std::chrono::sys_seconds(*day).time_since_epoch().count();
  if (rest.done()) return moment;
  if (!rest.one_of("Tt _") || !time_of_day(rest, false, moment)) return std::nullopt;
  const auto ahead_s = offset_s(rest);
  if (!ahead_s || !rest.done()) return std::nullopt;
  moment.s -= *ahead_s;
  return moment;
}

}  // namespace

std::string_view date_in_digits(std::string_view text, std::span<char, kLongestDate> to, DateOrder order) {
  constexpr std::size_t kWhole = 24;  // characters
  // Fast rejection of plain numbers: none has one of these near its beginning, or two points.
  const std::string_view begin = text.substr(0, 6);
  if (text.size() < 5 ||
      (begin.find_first_of(":/-_", 1) == std::string_view::npos && begin.find('.') == begin.rfind('.')))
    return {};
  auto moment = moment_of(text, order);
  if (!moment || moment->fraction.size() > to.size() - kWhole) return {};
  // Before 1970 decimal digits would have to count backwards.
  if (moment->s < 0 && !moment->fraction.empty()) return {};
  char* end = std::to_chars(to.data(), to.data() + kWhole, moment->s).ptr;
  if (!moment->fraction.empty()) {
    *end++ = '.';
    end = std::copy(moment->fraction.begin(), moment->fraction.end(), end);
  }
  return {to.data(), static_cast<std::size_t>(end - to.data())};
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

TimeDigits::TimeDigits(std::string_view cell, Notation by, DateOrder order) : PointDigits(cell, by) {
  const std::string_view date = date_in_digits(cell, made_, order);
  date_ = !date.empty();
  if (date_) digits_ = date;
}

}  // namespace ifog
