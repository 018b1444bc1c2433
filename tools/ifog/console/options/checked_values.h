// SPDX-License-Identifier: Apache-2.0
// What an option's value must be, and the words for one that is not: the value and what was expected.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace ifog::tools {

enum class ValueKind { text, number, whole, count };  // count: whole, 0 or more

// Decimal and finite, by the rule of drivers/ifog/decimal.h; empty: it is none.
std::optional<double> number_in(const std::string& text);

// Whole, within 63 bits and a sign; empty: it is none. (The parser takes the largest one for what is larger.)
std::optional<std::int64_t> whole_in(const std::string& text);

// What the values of one option are held to, beyond the type of the variable that they go to.
class ValueRule {
 public:
  explicit ValueRule(ValueKind kind) : kind_(kind) {}
  // words: "more than 0", "1 to 1000"; the help ends in them.
  void range(double least, double most, bool without_least, const std::string& words);
  void one_of(const std::vector<std::string>& words) { choices_ = words; }
  // Asked before the rest, for its words say more.
  void check(std::function<std::string(const std::string&)> complaint) { check_ = std::move(complaint); }

  // "" or "is 'VALUE', expected EXPECTED". word: for the value, in the help.
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
