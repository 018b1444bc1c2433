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

enum class ValueKind { text, number, whole, count };  // count: whole, 0 or more

struct ValueRule {
  ValueKind kind;
  double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
  bool without_least = false;
  std::string range{};  // "more than 0", "1 to 1000"; appended to the help
  std::vector<std::string> choices{};
  Complaint check{};  // before the other rules, because its message is more specific

  [[nodiscard]] bool fits(const std::string& value) const {
    if (kind == ValueKind::text)
      return choices.empty() ? !value.empty() : std::ranges::count(choices, value) > 0;
    // Whole numbers have 64 bits, signed or unsigned.
    const bool whole = integer_in<std::uint64_t>(value) || (kind == ValueKind::whole && whole_in(value));
    const std::optional<double> number = number_in(value);
    return (kind == ValueKind::number || whole) && number && *number <= most &&
           (without_least ? *number > least : *number >= least);
  }

  // "" or "is 'VALUE', expected EXPECTED". word: the value's name in the help.
  [[nodiscard]] std::string complaint(const std::string& value, const std::string& word) const {
    if (check)
      if (std::string wrong = check(value); !wrong.empty()) return wrong;
    if (fits(value)) return "";
    std::string expected = word;  // for an empty script variable: --model "$MODEL"
    if (!choices.empty()) expected = ifog::one_of(value, choices);
    if (kind != ValueKind::text) {
      expected = kind == ValueKind::number ? "a number" : "a whole number";
      if (const std::string words = range.empty() && kind == ValueKind::count ? "0 or more" : range;
          !words.empty())
        expected += " " + words;
    }
    return "is " + in_quotes(value) + ", expected " + expected;
  }
};

namespace {

template <typename T>
struct ValueOf {
  using type = T;
};
template <typename T>
struct ValueOf<std::optional<T>> : ValueOf<T> {};
template <typename T>
struct ValueOf<std::vector<T>> : ValueOf<T> {};

// Default of a value's name and rule, by the type of the variable.
template <typename T>
Option ruled(CLI::Option* option) {
  using Value = typename ValueOf<T>::type;
  const ValueKind kind = std::is_same_v<Value, std::string> ? ValueKind::text
                         : std::is_floating_point_v<Value>  ? ValueKind::number
                         : std::is_signed_v<Value>          ? ValueKind::whole
                                                            : ValueKind::count;
  const std::string name = option->get_name(option->get_positional());
  const auto text =
      std::ranges::find(kTexts, std::string_view(name), [](const auto& each) { return each.first; });
  option->type_name(kind == ValueKind::number ? "NUMBER"
                    : kind != ValueKind::text ? "N"
                    : text != kTexts.end()    ? text->second
                                              : "FILE");
  auto rule = std::make_shared<ValueRule>(ValueRule{kind});
  option->check(
      [rule, option](const std::string& value) { return rule->complaint(value, option->get_type_name()); });
  return Option(*option, std::move(rule));
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

Option Option::required() const { return Option(*option_->required(), rule_); }

Option Option::type_name(const std::string& word) const { return Option(*option_->type_name(word), rule_); }

Option Option::shows_default() const { return Option(*option_->capture_default_str(), rule_); }

Option Option::group(const std::string& heading) const { return Option(*option_->group(heading), rule_); }

Option Option::delimiter(char between) const { return Option(*option_->delimiter(between), rule_); }

Option Option::one_value_each() const { return Option(*option_->allow_extra_args(false), rule_); }

Option Option::ranged(double least, double most, bool without_least, const std::string& words) const {
  rule_->least = least;
  rule_->most = most;
  rule_->without_least = without_least;
  rule_->range = words;
  option_->description(option_->get_description() + "; " + words);
  return *this;
}

Option Option::positive() const {
  return ranged(0.0, std::numeric_limits<double>::infinity(), true, "more than 0");
}

Option Option::not_negative() const {
  return ranged(0.0, std::numeric_limits<double>::infinity(), false, "0 or more");
}

Option Option::within(double least, double most) const {
  return ranged(least, most, false, in_digits(least) + " to " + in_digits(most));
}

Option Option::within(int least, int most) const {
  return ranged(least, most, false, std::to_string(least) + " to " + std::to_string(most));
}

Option Option::one_of(const std::vector<std::string>& words) const {
  rule_->choices = words;
  std::string shown;
  for (const std::string& word : words) shown += (shown.empty() ? "" : "|") + word;
  return type_name(shown);
}

Option Option::check(Complaint complaint) const {
  rule_->check = std::move(complaint);
  return *this;
}

bool Option::given() const { return option_->count() > 0; }

Command Command::add_subcommand(const std::string& name, const std::string& help) const {
  return Command(*command_->add_subcommand(name, help));
}

template <typename T>
Option Command::add_option(const std::string& names, T& value, const std::string& help) const {
  return ruled<T>(command_->add_option(names, value, help));
}

template <typename T>
Option Command::add_taken(const std::string& names, std::function<void(const T&)> take,
                          const std::string& help) const {
  return ruled<T>(command_->add_option_function<T>(names, take, help));
}

Option Command::add_flag(const std::string& names, bool& value, const std::string& help) const {
  return Option(*command_->add_flag(names, value, help));
}

Option Command::add_flag_taken(const std::string& names, std::function<void()> take,
                               const std::string& help) const {
  return Option(*command_->add_flag_callback(names, std::move(take), help));
}

void Command::footer(const std::string& text) const { command_->footer(text); }

void Command::callback(std::function<void()> run) const { command_->callback(std::move(run)); }

// Types that commands use.
template Option Command::add_option(const std::string&, std::string&, const std::string&) const;
template Option Command::add_option(const std::string&, double&, const std::string&) const;
template Option Command::add_option(const std::string&, int&, const std::string&) const;
template Option Command::add_option(const std::string&, unsigned&, const std::string&) const;
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<std::uint64_t>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<double>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const double&)>,
                                   const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const std::int64_t&)>,
                                   const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const std::string&)>,
                                   const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const std::vector<double>&)>,
                                   const std::string&) const;

}  // namespace ifog::tools
