// SPDX-License-Identifier: Apache-2.0
// What an option's value must be, and the words for one that is not: the value and what was expected.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace CLI {
class Option;
class Validator;
}  // namespace CLI

namespace ifog::tools {

enum class ValueKind { text, number, whole, count };  // count: whole, 0 or more

// By the type as the parser names it, or as a command does.
ValueKind value_kind(const std::string& type);

// Decimal and finite, by the rule of drivers/ifog/decimal.h; empty: it is none.
std::optional<double> number_in(const std::string& text);

// Whole, within 63 bits and a sign; empty: it is none. (The parser takes the largest one for what is larger.)
std::optional<std::int64_t> whole_in(const std::string& text);

// Decimal and finite; whole where the kind says so, and within 64 bits.
bool is_number(const std::string& text, ValueKind kind);

// "a number more than 0"; "a whole number 1 to 1000". range: of it, may be "".
std::string number_in_words(ValueKind kind, const std::string& range);

// The check's own words become: is 'VALUE', expected EXPECTED, which may depend on the value.
void say_expected(CLI::Validator& check, std::function<std::string(const std::string&)> expected);

// The option takes what is_number() says, and nothing else.
void hold_to_number(CLI::Option& option, ValueKind kind, const std::string& expected);

// The option takes no empty text. word: for what it takes.
void hold_to_something(CLI::Option& option, const std::string& word);

}  // namespace ifog::tools
