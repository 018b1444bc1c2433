// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>

#include "drivers/ifog/decimal.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/command_files.h"

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

namespace {

enum class ValueKind { text, number, whole, count };  // count: whole, 0 or more

bool fits(const OptionRule& rule, ValueKind kind, const std::string& value) {
  if (kind == ValueKind::text)
    return rule.choices.empty() ? !value.empty() : std::ranges::count(rule.choices, value) > 0;
  // Whole numbers have 64 bits, signed or unsigned.
  const bool whole = integer_in<std::uint64_t>(value) || (kind == ValueKind::whole && whole_in(value));
  const std::optional<double> number = number_in(value);
  return (kind == ValueKind::number || whole) && number && *number <= rule.range.most &&
         (rule.range.without_least ? *number > rule.range.least : *number >= rule.range.least);
}

// "" or "is 'VALUE', expected EXPECTED". word: the value's name in the help.
std::string complaint(const OptionRule& rule, ValueKind kind, const std::string& value,
                      const std::string& word) {
  if (rule.check)
    if (std::string wrong = rule.check(value); !wrong.empty()) return wrong;
  if (fits(rule, kind, value)) return "";
  std::string expected = word;  // for an empty script variable: --model "$MODEL"
  if (!rule.choices.empty()) expected = one_of(value, rule.choices);
  if (kind != ValueKind::text) {
    expected = kind == ValueKind::number ? "a number" : "a whole number";
    if (const std::string words =
            rule.range.words.empty() && kind == ValueKind::count ? "0 or more" : rule.range.words;
        !words.empty())
      expected += " " + words;
  }
  return "is " + in_quotes(value) + ", expected " + expected;
}

template <typename T>
struct ValueOf {
  using type = T;
};
template <typename T>
struct ValueOf<std::optional<T>> : ValueOf<T> {};
template <typename T>
struct ValueOf<std::vector<T>> : ValueOf<T> {};

template <typename T>
void follow(const OptionRule& rule, CLI::Option* option) {
  using Value = typename ValueOf<T>::type;
  const ValueKind kind = std::is_same_v<Value, std::string> ? ValueKind::text
                         : std::is_floating_point_v<Value>  ? ValueKind::number
                         : std::is_signed_v<Value>          ? ValueKind::whole
                                                            : ValueKind::count;
  const std::string choices = boost::join(rule.choices, "|");
  const char* const usual = kind == ValueKind::number    ? "NUMBER"
                            : kind != ValueKind::text    ? "N"
                            : rule.file != FileUse::none ? "FILE"
                                                         : "NAME";
  option->type_name(!choices.empty() ? choices : rule.type.empty() ? usual : rule.type);
  option->check([rule, kind, option](const std::string& value) {
    return complaint(rule, kind, value, option->get_type_name());
  });
  if (!rule.range.words.empty()) option->description(option->get_description() + "; " + rule.range.words);
  if (rule.required) option->required();
  if (rule.shows_default) option->capture_default_str();
  if (rule.one_value_each) option->allow_extra_args(false);
  if (!rule.group.empty()) option->group(rule.group);
  if (rule.delimiter != '\0') option->delimiter(rule.delimiter);
}

// "1e9", "0.5".
std::string in_digits(double value) {
  std::string text = fmt::format("{:g}", value);
  for (const auto& [from, to] : {std::pair{"e+0", "e"}, {"e-0", "e-"}, {"e+", "e"}})
    boost::replace_all(text, from, to);
  return text;
}

}  // namespace

ValueRange positive() { return {.least = 0.0, .without_least = true, .words = "more than 0"}; }

ValueRange not_negative() { return {.least = 0.0, .words = "0 or more"}; }

ValueRange within(double least, double most) {
  return {least, most, false, in_digits(least) + " to " + in_digits(most)};
}

Command Command::add_subcommand(const std::string& name, const std::string& help) const {
  return Command(*command_->add_subcommand(name, help));
}

template <typename T>
void Command::name_files(const std::string& names, const T& value, const OptionRule& rule) const {
  const auto name_in = [option = names.substr(names.rfind(',') + 1), rule](const std::string& path) {
    rule.file == FileUse::read ? will_read(option, path) : will_write(option, path, rule.endings);
  };
  auto& files = rule.file == FileUse::read ? files_->read : files_->written;
  if (rule.file == FileUse::none) return;
  if constexpr (std::is_same_v<T, std::string>) files.emplace_back([name_in, &value] { name_in(value); });
  if constexpr (std::is_same_v<T, std::vector<std::string>>)
    files.emplace_back([name_in, &value] { std::ranges::for_each(value, name_in); });
}

template <typename T>
void Command::add_option(const std::string& names, T& value, const std::string& help,
                         const OptionRule& rule) const {
  follow<T>(rule, command_->add_option(names, value, help));
  name_files(names, value, rule);
}

template <typename T>
void Command::add_taken(const std::string& names, std::function<void(const T&)> take, const std::string& help,
                        const OptionRule& rule) const {
  follow<T>(rule, command_->add_option_function<T>(names, take, help));
}

void Command::add_flag(const std::string& names, bool& value, const std::string& help) const {
  command_->add_flag(names, value, help);
}

void Command::add_flag_taken(const std::string& names, std::function<void()> take, const std::string& help,
                             const std::string& group) const {
  command_->add_flag_callback(names, std::move(take), help)->group(group);
}

void Command::footer(const std::string& text) const { command_->footer(text); }

void Command::before_run(std::function<void()> registers) const {
  files_->read.push_back(std::move(registers));
}

void Command::callback(std::function<void()> run) const {
  command_->callback([files = files_, run = std::move(run)] {
    for (const auto& list : {files->read, files->written})
      for (const auto& registers : list) registers();
    run();
  });
}

// Types that commands use.
using Text = const std::string&;
template void Command::add_option(Text, std::string&, Text, const OptionRule&) const;
template void Command::add_option(Text, double&, Text, const OptionRule&) const;
template void Command::add_option(Text, int&, Text, const OptionRule&) const;
template void Command::add_option(Text, unsigned&, Text, const OptionRule&) const;
template void Command::add_option(Text, std::uint64_t&, Text, const OptionRule&) const;
template void Command::add_option(Text, std::optional<double>&, Text, const OptionRule&) const;
template void Command::add_option(Text, std::optional<std::uint64_t>&, Text, const OptionRule&) const;
template void Command::add_option(Text, std::vector<double>&, Text, const OptionRule&) const;
template void Command::add_option(Text, std::vector<std::string>&, Text, const OptionRule&) const;
template void Command::add_taken(Text, std::function<void(const double&)>, Text, const OptionRule&) const;
template void Command::add_taken(Text, std::function<void(const std::int64_t&)>, Text,
                                 const OptionRule&) const;
template void Command::add_taken(Text, std::function<void(const std::string&)>, Text,
                                 const OptionRule&) const;
template void Command::add_taken(Text, std::function<void(const std::vector<double>&)>, Text,
                                 const OptionRule&) const;

}  // namespace ifog::tools
