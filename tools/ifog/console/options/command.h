// SPDX-License-Identifier: Apache-2.0
// What a command is called, takes and does, in plain types. The parser behind it is CLI11, which this room
// alone reads: it is headers, and whatever includes them compiles all of the parser again.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ifog::tools {

// "" or what is wrong with a value.
using Complaint = std::function<std::string(const std::string& value)>;

// What an option takes, see checked_values.h.
class ValueRule;

// Stands for an option of the command line, and lives no longer than that. Its help and what is said of a wrong value
// come from the same rule, so that they are in the same words.
class Option {
 public:
  explicit Option(CLI::Option& option, std::shared_ptr<ValueRule> rule = nullptr)
      : option_(&option), rule_(std::move(rule)) {}

  Option required() const;
  // The word for its value, in the help.
  Option type_name(const std::string& word) const;
  // The help says what its variable now holds.
  Option shows_default() const;
  Option group(const std::string& heading) const;
  // Between the values of one word.
  Option delimiter(char between) const;
  // It is given once for each value: a word that follows the first is not its own.
  Option one_value_each() const;

  Option positive() const;
  Option not_negative() const;
  // Both ends allowed.
  Option within(double least, double most) const;
  Option within(int least, int most) const;
  // The help has them as a|b in the place of a word for the value.
  Option one_of(const std::vector<std::string>& words) const;
  Option check(Complaint complaint) const;

  // Whether it stands on the command line.
  [[nodiscard]] bool given() const;

 private:
  [[nodiscard]] Option ranged(double least, double most, bool without_least, const std::string& words) const;

  CLI::Option* option_;
  std::shared_ptr<ValueRule> rule_;  // null: a flag
};

// Stands for a command, or for the program whose commands there are.
class Command {
 public:
  explicit Command(CLI::App& command) : command_(&command) {}

  [[nodiscard]] Command add_subcommand(const std::string& name, const std::string& help) const;

  // `value` must outlive the parse. A name without dashes is an argument. T: what command.cpp lists, texts,
  // numbers, and optional or several ones.
  template <typename T>
  Option add_option(const std::string& names, T& value, const std::string& help) const;
  Option add_flag(const std::string& names, bool& value, const std::string& help) const;
  // Called with the value when all has been read; throws WrongUsage where it will not do.
  template <typename T>
  Option add_taken(const std::string& names, std::function<void(const T&)> take,
                   const std::string& help) const;
  Option add_flag_taken(const std::string& names, std::function<void()> take, const std::string& help) const;

  // Examples, behind the options in the help.
  void footer(const std::string& text) const;
  // What it does; throws WrongUsage, Failed or what goes wrong.
  void callback(std::function<void()> run) const;

 private:
  CLI::App* command_;
};

}  // namespace ifog::tools
