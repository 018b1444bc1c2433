// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "drivers/ifog/decimal.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"

namespace ifog::tools {

namespace {

// Options whose values are not files. The value's name is the same in every command.
constexpr std::array<std::pair<std::string_view, const char*>, 9> kTexts = {{{"--axis", "NAME"},
                                                                             {"--channel", "NAME"},
                                                                             {"--filter", "NAME"},
                                                                             {"--sensor", "NAME"},
                                                                             {"--state", "NAME"},
                                                                             {"--weights", "NAME"},
                                                                             {"--to", "WHERE"},
                                                                             {"NAME", "NAME"},
                                                                             {"sensor", "NAME"}}};

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

// The value's name in the help, if the rule has none.
std::string type_of(const CLI::Option& option, ValueKind kind) {
  if (kind != ValueKind::text) return kind == ValueKind::number ? "NUMBER" : "N";
  const std::string name = option.get_name(option.get_positional());
  const auto text =
      std::ranges::find(kTexts, std::string_view(name), [](const auto& each) { return each.first; });
  return text != kTexts.end() ? text->second : "FILE";
}

template <typename T>
void follow(const OptionRule& rule, CLI::Option* option) {
  using Value = typename ValueOf<T>::type;
  const ValueKind kind = std::is_same_v<Value, std::string> ? ValueKind::text
                         : std::is_floating_point_v<Value>  ? ValueKind::number
                         : std::is_signed_v<Value>          ? ValueKind::whole
                                                            : ValueKind::count;
  std::string choices;
  for (const std::string& word : rule.choices) choices += (choices.empty() ? "" : "|") + word;
  option->type_name(!choices.empty() ? choices : rule.type.empty() ? type_of(*option, kind) : rule.type);
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

std::string in_digits(double value) {
  std::ostringstream out;
  out << value;
  std::string text = out.str();
  for (const auto& [from, to] : {std::pair{"e+0", "e"}, {"e-0", "e-"}, {"e+", "e"}})
    if (const std::size_t at = text.find(from); at != std::string::npos)
      text.replace(at, std::string_view(from).size(), to);
  return text;
}

}  // namespace

ValueRange positive() { return {.least = 0.0, .without_least = true, .words = "more than 0"}; }

ValueRange not_negative() { return {.least = 0.0, .words = "0 or more"}; }

ValueRange within(double least, double most) {
  return {least, most, false, in_digits(least) + " to " + in_digits(most)};
}

ValueRange within(int least, int most) {
  return {static_cast<double>(least), static_cast<double>(most), false,
          std::to_string(least) + " to " + std::to_string(most)};
}

Command Command::add_subcommand(const std::string& name, const std::string& help) const {
  return Command(*command_->add_subcommand(name, help));
}

template <typename T>
void Command::add_option(const std::string& names, T& value, const std::string& help,
                         const OptionRule& rule) const {
  follow<T>(rule, command_->add_option(names, value, help));
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

void Command::callback(std::function<void()> run) const { command_->callback(std::move(run)); }

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
