// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/times/time_stamps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace ifog {
namespace {

constexpr int kExactPower = 15;  // powers of ten up to this, and integers below 2^53, are exact doubles
constexpr double kWholeDoubles = 9007199254740992.0;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kMostWhole = 4'600'000'000'000'000'000;  // differences of two fit into 64 bits

constexpr std::array<std::int64_t, 19> kTen = [] {
  std::array<std::int64_t, 19> powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = 10 * powers[i - 1];
  return powers;
}();
std::int64_t ten_to(int decimals) { return kTen[static_cast<std::size_t>(decimals)]; }

// whole + fraction / 10^decimals, both with the number's sign.
struct Plain {
  std::int64_t whole = 0, fraction = 0;
  int decimals = 0;
};

// Reads up to `most` digits; returns their number.
int take_digits(const char*& at, const char* end, int most, std::int64_t& value) {
  int digits = 0;
  for (; at != end && *at >= '0' && *at <= '9' && digits < most; ++at, ++digits)
    value = 10 * value + (*at - '0');
  return digits;
}

bool read_plain(std::string_view text, Plain& out) {
  const char* at = text.data();
  const char* const end = at + text.size();
  const bool negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  int digits = take_digits(at, end, 18, out.whole);
  if (at != end && *at >= '0' && *at <= '9' && out.whole < kMostWhole / 10)
    digits += take_digits(at, end, 1, out.whole);
  if (at != end && *at == '.') digits += out.decimals = take_digits(++at, end, 18, out.fraction);
  if (at != end || digits == 0) return false;
  if (negative) out.whole = -out.whole, out.fraction = -out.fraction;
  return true;
}

std::int64_t floor_to(std::int64_t value, std::int64_t unit) {
  const std::int64_t over = value % unit;
  return value - over - (over < 0 ? unit : 0);
}

// The value if it is an integer, else 0.
std::int64_t whole(double value) {
  const double nearest = std::round(value);
  return nearest >= 1.0 && std::abs(value / nearest - 1.0) < 1e-12 ? static_cast<std::int64_t>(nearest) : 0;
}

// Decimal digits of one minus the fraction: 0.75 for 0.25. Not for zero.
void complement(std::string& digits) {
  for (char& digit : digits) digit = static_cast<char>('0' + '9' - digit);
  digits.back() = static_cast<char>(digits.back() + 1);
}

// Adds ns to decimal digits, without trailing zeros; true on carry.
bool add_ns(std::string& digits, std::int64_t ns) {
  constexpr std::size_t kOfNs = 9;
  if (ns == 0) return false;
  if (digits.size() < kOfNs) digits.resize(kOfNs, '0');
  std::int64_t carry = ns;
  for (std::size_t i = kOfNs; i-- > 0; carry /= 10) {
    carry += digits[i] - '0';
    digits[i] = static_cast<char>('0' + carry % 10);
  }
  digits.erase(digits.find_last_not_of('0') + 1);
  return carry > 0;
}

// Day number of 1970-01-01: MATLAB counts from the year 0, spreadsheets from 1899-12-30, others from 1970.
std::int64_t day_of_1970(double unit_s, std::int64_t day) {
  if (unit_s != 86'400.0) return 0;
  return day >= 700'000 ? 719'529 : day >= 36'526 ? 25'569 : 0;
}

}  // namespace

TimeOrigin TimeOrigin::of(std::int64_t first_ns) {
  if (std::abs(static_cast<double>(first_ns)) * 1e-9 < kFineTimes_s) return {};
  const std::int64_t over = first_ns % kNsPerSecond;
  return {first_ns / kNsPerSecond - (over < 0 ? 1 : 0), over < 0 ? over + kNsPerSecond : over};
}

std::optional<SaidTime> SaidTime::parse(std::string_view said) {
  const TimeDigits digits(said, {});
  const std::string_view text = digits;
  if (Plain time; read_plain(text, time))
    return SaidTime{static_cast<double>(time.whole),
                    static_cast<double>(time.fraction) / static_cast<double>(ten_to(time.decimals))};
  const std::optional<double> value = finite_number(text);
  return value ? std::optional(SaidTime{*value, 0.0}) : std::nullopt;
}

TimeStamps::TimeStamps(std::string_view first, double unit_s)
    : unit_s_(unit_s), units_a_second_(whole(1.0 / unit_s)) {
  Plain time;
  if (!read_plain(first, time) || std::abs(static_cast<double>(time.whole)) * unit_s < kFineTimes_s) return;
  const std::int64_t below = time.whole - (time.fraction < 0 ? 1 : 0);
  // Units per second as a power of ten
  const auto part = std::find(kTen.begin(), kTen.begin() + 10, units_a_second_);
  if (part != kTen.begin() + 10 && *part > 0) {
    const std::int64_t of_second = *part, ns_a_unit = kNsPerSecond / of_second;
    whole_ = below;
    decimals_ = 9 - static_cast<int>(part - kTen.begin());  // of one ns in this unit
    const std::int64_t fraction = time.fraction < 0 ? ten_to(time.decimals) + time.fraction : time.fraction;
    fraction_ = time.decimals > decimals_ ? fraction / ten_to(time.decimals - decimals_)
                                          : fraction * ten_to(decimals_ - time.decimals);
    origin_.s = floor_to(below, of_second) / of_second;
    origin_.ns = (below - floor_to(below, of_second)) * ns_a_unit + fraction_;
    for (; decimals_ > 0 && fraction_ % 10 == 0; --decimals_) fraction_ /= 10;
  } else if (const std::int64_t seconds = whole(unit_s);
             seconds != 0 && std::abs(below) < kMostWhole / seconds) {
    whole_ = below;
    origin_.s = (below - day_of_1970(unit_s, below)) * seconds;
  }
}

// A single division, so that 0.01 s is the same in every unit.
double TimeStamps::seconds(double value, double parts_of_unit) const {
  return units_a_second_ > 0 ? value / (parts_of_unit * static_cast<double>(units_a_second_))
                             : value / parts_of_unit * unit_s_;
}

double TimeStamps::since(double absolute) const {
  const double beyond = static_cast<double>(fraction_) / static_cast<double>(ten_to(decimals_));
  return seconds(absolute - static_cast<double>(whole_) - beyond, 1.0);
}

bool TimeStamps::since(std::string_view text, double& value) const {
  Plain time;
  if (!read_plain(text, time)) return false;
  const int behind = std::max(time.decimals, decimals_);
  const std::int64_t since = time.whole - whole_;
  const std::int64_t fraction =
      time.fraction * ten_to(behind - time.decimals) - fraction_ * ten_to(behind - decimals_);
  const auto ten = static_cast<double>(ten_to(behind));
  // Then only one division rounds.
  if (behind <= kExactPower && std::abs(static_cast<double>(since)) < kWholeDoubles / ten - 2.0) {
    value = seconds(static_cast<double>(since * ten_to(behind) + fraction), ten);
    return true;
  }
  if (origin_ == TimeOrigin{}) return false;
  value = seconds(static_cast<double>(since) + static_cast<double>(fraction) / ten, 1.0);
  return true;
}

void append_time(std::string& out, const TimeOrigin& origin, double since_s) {
  const double below_s = std::floor(since_s);
  std::array<char, 400> text{};
  // Digits of the absolute value.
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), std::abs(since_s), std::chars_format::fixed);
  (void)error;  // 400 characters suffice for any double
  char* const point = std::find(text.data(), end, '.');
  std::string fraction(point == end ? end : point + 1, end);
  if (since_s < 0.0 && !fraction.empty()) complement(fraction);
  const std::int64_t seconds =
      origin.s + static_cast<std::int64_t>(below_s) + (add_ns(fraction, origin.ns) ? 1 : 0);
  if (seconds >= 0 || fraction.empty()) {
    out += std::to_string(seconds);
  } else {
    out += '-' + std::to_string(-(seconds + 1));
    complement(fraction);
  }
  if (!fraction.empty()) (out += '.') += fraction;
}

}  // namespace ifog
