// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/checked_values.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "drivers/ifog/decimal.h"
#include "drivers/ifog/quoted.h"

namespace ifog::tools {
namespace {

constexpr std::array<std::pair<std::string_view, ValueKind>, 7> kKinds = {{{"FLOAT", ValueKind::number},
                                                                           {"SECONDS", ValueKind::number},
                                                                           {"S", ValueKind::number},
                                                                           {"INT", ValueKind::whole},
                                                                           {"UINT", ValueKind::count},
                                                                           {"N", ValueKind::count},
                                                                           {"INDEX", ValueKind::count}}};

// All of the text as a T.
template <typename T>
bool read(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::string_view without_plus(std::string_view digits) {
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  return digits;
}

std::string complaint(const std::string& value, const std::string& expected) {
  return "is " + in_quotes(value) + ", expected " + expected;
}

}  // namespace

ValueKind value_kind(const std::string& type) {
  const auto found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& each) { return each.first == type; });
  return found == kKinds.end() ? ValueKind::text : found->second;
}

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = read_decimal(text.data(), end, value);
  if (error != std::errc() || at != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> whole_in(const std::string& text) {
  std::int64_t value = 0;
  if (!read(without_plus(text), value)) return std::nullopt;
  return value;
}

bool is_number(const std::string& text, ValueKind kind) {
  if (kind == ValueKind::number) return number_in(text).has_value();
  const std::string_view digits = without_plus(text);
  std::int64_t whole = 0;
  std::uint64_t count = 0;
  if (kind == ValueKind::count) return read(digits, count);
  return read(digits, whole) || read(digits, count);
}

std::string number_in_words(ValueKind kind, const std::string& range) {
  std::string out = kind == ValueKind::number ? "a number" : "a whole number";
  if (!range.empty()) return out + " " + range;
  return kind == ValueKind::count ? out + " 0 or more" : out;
}

void say_expected(CLI::Validator& check, std::function<std::string(const std::string&)> expected) {
  const CLI::Validator before = check;
  check.operation([before, expected = std::move(expected)](std::string& value) {
    const std::string given = value;
    return before(value).empty() ? std::string() : complaint(given, expected(given));
  });
}

void hold_to_something(CLI::Option& option, const std::string& word) {
  option.check(
      [word](const std::string& value) { return value.empty() ? complaint(value, word) : std::string(); });
}

void hold_to_number(CLI::Option& option, ValueKind kind, const std::string& expected) {
  option.check([kind, expected](const std::string& value) {
    return is_number(value, kind) ? std::string() : complaint(value, expected);
  });
}

}  // namespace ifog::tools
