// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/checked_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "drivers/ifog/decimal.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"

namespace ifog::tools {
namespace {

// Parses the whole text as a T; a leading plus sign is allowed.
template <typename T>
std::optional<T> integer_in(std::string_view digits) {
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = read_decimal(text.data(), end, value);
  if (error != std::errc() || at != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> whole_in(const std::string& text) { return integer_in<std::int64_t>(text); }

void ValueRule::range(double least, double most, bool without_least, const std::string& words) {
  least_ = least;
  most_ = most;
  without_least_ = without_least;
  range_ = words;
}

bool ValueRule::fits(const std::string& value) const {
  if (kind_ == ValueKind::text)
    return choices_.empty() ? !value.empty() : std::ranges::count(choices_, value) > 0;
  // Whole numbers have 64 bits, signed or unsigned.
  const bool whole = integer_in<std::uint64_t>(value) || (kind_ == ValueKind::whole && whole_in(value));
  const std::optional<double> number = number_in(value);
  return (kind_ == ValueKind::number || whole) && number && *number <= most_ &&
         (without_least_ ? *number > least_ : *number >= least_);
}

std::string ValueRule::complaint(const std::string& value, const std::string& word) const {
  if (check_)
    if (std::string wrong = check_(value); !wrong.empty()) return wrong;
  if (fits(value)) return "";
  std::string expected = word;  // for an empty script variable: --model "$MODEL"
  if (!choices_.empty()) expected = ifog::one_of(value, choices_);
  if (kind_ != ValueKind::text) {
    expected = kind_ == ValueKind::number ? "a number" : "a whole number";
    if (const std::string range = range_.empty() && kind_ == ValueKind::count ? "0 or more" : range_;
        !range.empty())
      expected += " " + range;
  }
  return "is " + in_quotes(value) + ", expected " + expected;
}

}  // namespace ifog::tools
