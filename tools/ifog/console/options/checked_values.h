// SPDX-License-Identifier: Apache-2.0
// Rules for the values of options, and the error messages of wrong values.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace ifog::tools {

enum class ValueKind { text, number, whole, count };  // count: whole, 0 or more

// Decimal and finite, as in drivers/ifog/decimal.h; otherwise nullopt.
std::optional<double> number_in(const std::string& text);

// Whole and within 64 bits, signed; otherwise nullopt. (The parser would clamp larger numbers.)
std::optional<std::int64_t> whole_in(const std::string& text);

// Rule for the values of one option, besides the type of its variable.
class ValueRule {
 public:
  explicit ValueRule(ValueKind kind) : kind_(kind) {}
  // words: "more than 0", "1 to 1000"; appended to the help.
  void range(double least, double most, bool without_least, const std::string& words);
  void one_of(const std::vector<std::string>& words) { choices_ = words; }
  // Checked before the other rules, because its message is more specific.
  void check(std::function<std::string(const std::string&)> complaint) { check_ = std::move(complaint); }

  // "" or "is 'VALUE', expected EXPECTED". word: the value's name in the help.
  [[nodiscard]] std::string complaint(const std::string& value, const std::string& word) const;

 private:
  [[nodiscard]] bool fits(const std::string& value) const;

  ValueKind kind_;
  double least_ = -std::numeric_limits<double>::infinity(), most_ = std::numeric_limits<double>::infinity();
  bool without_least_ = false;
  std::string range_;
  std::vector<std::string> choices_;
  std::function<std::string(const std::string&)> check_;
};

}  // namespace ifog::tools
