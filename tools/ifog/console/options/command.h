// SPDX-License-Identifier: Apache-2.0
// Names, options and actions of a command in plain types. Only this folder includes CLI11, because its
// headers contain the whole parser.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ifog::tools {

// Returns "" or the error in a value.
using Complaint = std::function<std::string(const std::string& value)>;

// Decimal and finite, as in drivers/ifog/decimal.h; otherwise nullopt.
std::optional<double> number_in(const std::string& text);

// Whole and within 64 bits, signed; otherwise nullopt. (The parser would clamp larger numbers.)
std::optional<std::int64_t> whole_in(const std::string& text);

// Rule for the values of one option, besides the type of its variable.
struct ValueRule;

// Handle of an option; valid as long as the command line. Help and error messages come from one rule.
class Option {
 public:
  explicit Option(CLI::Option& option, std::shared_ptr<ValueRule> rule = nullptr)
      : option_(&option), rule_(std::move(rule)) {}

  Option required() const;
  // Sets the value's name in the help.
  Option type_name(const std::string& word) const;
  // Shows the present value of the variable as default.
  Option shows_default() const;
  Option group(const std::string& heading) const;
  // Separator of several values in one word.
  Option delimiter(char between) const;
  // Each value needs the option again: the next word is not a value.
  Option one_value_each() const;

  Option positive() const;
  Option not_negative() const;
  // Both limits are allowed.
  Option within(double least, double most) const;
  Option within(int least, int most) const;
  // The help shows them as a|b instead of a value's name.
  Option one_of(const std::vector<std::string>& words) const;
  Option check(Complaint complaint) const;

  // True if it is on the command line.
  [[nodiscard]] bool given() const;

 private:
  [[nodiscard]] Option ranged(double least, double most, bool without_least, const std::string& words) const;

  CLI::Option* option_;
  std::shared_ptr<ValueRule> rule_;  // null: a flag
};

// Handle of a command, or of the program with its commands.
class Command {
 public:
  explicit Command(CLI::App& command) : command_(&command) {}

  [[nodiscard]] Command add_subcommand(const std::string& name, const std::string& help) const;

  // `value` must outlive the parse. A name without dashes is an argument. T: the types listed in command.cpp:
  // texts, numbers, and optional or several of them.
  template <typename T>
  Option add_option(const std::string& names, T& value, const std::string& help) const;
  Option add_flag(const std::string& names, bool& value, const std::string& help) const;
  // Called with the value after the parse; may throw WrongUsage.
  template <typename T>
  Option add_taken(const std::string& names, std::function<void(const T&)> take,
                   const std::string& help) const;
  Option add_flag_taken(const std::string& names, std::function<void()> take, const std::string& help) const;

  // Text after the options in the help, e.g. examples.
  void footer(const std::string& text) const;
  // The action; may throw WrongUsage, Failed or other errors.
  void callback(std::function<void()> run) const;

 private:
  CLI::App* command_;
};

}  // namespace ifog::tools
