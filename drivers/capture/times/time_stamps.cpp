// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/times/time_stamps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace ifog {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

// The value if it is an integer, else 0.
std::int64_t whole(double value) {
  const double nearest = std::round(value);
  return nearest >= 1.0 && std::abs(value / nearest - 1.0) < 1e-12 ? static_cast<std::int64_t>(nearest) : 0;
}

// Decimal digits of one ns in a unit of which so many are a second; nullopt if that is no power of ten.
std::optional<int> decimals_of_ns(std::int64_t units_a_second) {
  for (int decimals = 0; decimals <= 9; ++decimals)
    if (ten_to(9 - decimals) == units_a_second) return decimals;
  return std::nullopt;
}

// Day number of 1970-01-01: MATLAB counts from the year 0, spreadsheets from 1899-12-30, others from 1970.
std::int64_t day_of_1970(double unit_s, Int128 day) {
  if (unit_s != 86'400.0) return 0;
  return day >= 700'000 ? 719'529 : day >= 36'526 ? 25'569 : 0;
}

// Appends a positive number with leading zeros.
void append_digits(std::string& out, Int128 number, int width) {
  constexpr int kAtOnce = 18;
  if (width > kAtOnce) append_digits(out, number / ten_to(kAtOnce), width - kAtOnce);
  const std::string digits = std::to_string(static_cast<std::uint64_t>(number % ten_to(kAtOnce)));
  out.append(static_cast<std::size_t>(std::min(width, kAtOnce)) - digits.size(), '0').append(digits);
}

}  // namespace

TimeOrigin TimeOrigin::of(std::int64_t first_ns) {
  if (std::abs(static_cast<double>(first_ns)) * 1e-9 < kFineTimes_s) return {};
  const std::int64_t over = first_ns % kNsPerSecond;
  return {first_ns / kNsPerSecond - (over < 0 ? 1 : 0), over < 0 ? over + kNsPerSecond : over};
}

std::optional<SaidTime> SaidTime::parse(std::string_view said) {
  const PointDigits digits(said, {});
  const auto date = date_time(said), exact = date ? date : Decimal::parse(digits);
  if (exact)
    return SaidTime{static_cast<double>(exact->value / ten_to(exact->decimals)),
                    Decimal{exact->value % ten_to(exact->decimals), exact->decimals}.in_double()};
  const std::optional<double> value = finite_number(digits);
  return value ? std::optional(SaidTime{*value, 0.0}) : std::nullopt;
}

TimeStamps::TimeStamps(std::optional<Decimal> first, double unit_s)
    : unit_s_(unit_s), units_a_second_(whole(1.0 / unit_s)) {
  constexpr double kMost_s = 9e9, kMostFromYear0_s = 1e12;  // of int64 in ns; of days in MATLAB
  const double first_s = first ? std::abs(first->in_double()) * unit_s : 0.0;
  if (first_s < kFineTimes_s || first_s > kMostFromYear0_s) return;
  if (const auto decimals = decimals_of_ns(units_a_second_); decimals && first_s < kMost_s) {
    base_ = {first->with(*decimals), *decimals};
    origin_ = TimeOrigin::of(static_cast<std::int64_t>(base_.value));
  } else if (const std::int64_t seconds = whole(unit_s); seconds != 0) {
    base_ = {first->with(0), 0};
    origin_.s = static_cast<std::int64_t>(base_.value - day_of_1970(unit_s, base_.value)) * seconds;
  }
}

// A single division, so that 0.01 s is the same in every unit.
double TimeStamps::seconds(double value, double parts_of_unit) const {
  return units_a_second_ > 0 ? value / (parts_of_unit * static_cast<double>(units_a_second_))
                             : value / parts_of_unit * unit_s_;
}

double TimeStamps::since(double absolute) const {
  const Int128 one = ten_to(base_.decimals), whole = base_.value / one;
  const double beyond = Decimal{base_.value % one, base_.decimals}.in_double();
  return seconds(absolute - static_cast<double>(whole) - beyond, 1.0);
}

std::optional<double> TimeStamps::since(const Decimal& time) const {
  constexpr int kExactPower = 15;  // powers of ten up to this, and integers below 2^53, are exact doubles
  constexpr double kWholeDoubles = 9007199254740992.0;
  const Decimal later{time.with(std::max(time.decimals, base_.decimals)) -
                          base_.with(std::max(time.decimals, base_.decimals)),
                      std::max(time.decimals, base_.decimals)};
  const auto parts = static_cast<double>(later.value), one = static_cast<double>(ten_to(later.decimals));
  // Then only one division rounds.
  if (later.decimals <= kExactPower && std::abs(parts) < kWholeDoubles) return seconds(parts, one);
  if (origin_ == TimeOrigin{}) return std::nullopt;
  return seconds(later.in_double(), 1.0);
}

void append_time(std::string& out, const TimeOrigin& origin, double since_s) {
  constexpr int kMostDecimals = 27;
  std::array<char, 400> text{};  // suffices for any double
  const char* const end =
      std::to_chars(text.data(), text.data() + text.size(), since_s + 0.0, std::chars_format::fixed).ptr;
  const std::string_view digits(text.data(), static_cast<std::size_t>(end - text.data()));
  const auto since = Decimal::parse(
      digits.substr(0, std::min(digits.find('.'), digits.size()) + 1 + kMostDecimals), kMostDecimals);
  if (origin == TimeOrigin{} || !since) {
    out += digits;
    return;
  }
  const int decimals = std::max(since->decimals, 9);
  const Decimal from{Int128{origin.s} * kNsPerSecond + origin.ns, 9};
  Int128 time = from.with(decimals) + since->with(decimals);
  if (time < 0) out += '-';
  if (time < 0) time = -time;
  out += std::to_string(static_cast<std::uint64_t>(time / ten_to(decimals)));
  out += '.';
  append_digits(out, time % ten_to(decimals), decimals);
  out.erase(out.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
}

}  // namespace ifog
