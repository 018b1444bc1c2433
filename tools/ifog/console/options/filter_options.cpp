// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/filter_options.h"

#include <cmath>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "drivers/ifog/quoted.h"
#include "filters/rules/names.h"
#include "filters/settings/filter_table.h"
#include "tools/ifog/console/options/checked_values.h"
#include "tools/ifog/console/options/command.h"
#include "tools/ifog/console/options/wrong_usage.h"

namespace ifog::tools {
namespace {

// What the command line reads the value as, before it is narrowed.
template <typename T>
using Read = std::conditional_t<std::is_integral_v<T>, std::int64_t, T>;

std::string help(const FilterSetting& setting) {
  std::string out = setting.help;
  if (setting.unit[0] != '\0') out += std::string(", ") + setting.unit;
  const bool ranged = !std::isinf(setting.range.least) || !setting.choices.empty();
  return ranged ? out + "; " + expected(setting) : out;
}

// "" or what is wrong with a name that another room than the table knows.
std::string wrong_name(const FilterSetting& setting, const std::string& name) {
  const std::string expected = expected_name(setting, name);
  return expected.empty() ? "" : "is " + in_quotes(name) + ", expected " + expected;
}

// A whole number may stand for one that is not; the rest of it the setting's row knows.
template <typename T>
std::string wrong_number(const FilterSetting& setting, const std::string& text) {
  constexpr bool kWhole = std::is_integral_v<T>;
  FilterChoice ignored;
  bool good = is_number(text, kWhole ? ValueKind::whole : ValueKind::number);
  if constexpr (kWhole) {
    good = good && whole_in(text) && choose(setting, *whole_in(text), ignored);
  } else if constexpr (std::is_same_v<T, double>) {
    good = good && choose(setting, *number_in(text), ignored);
  }
  return good ? "" : "is " + in_quotes(text) + ", expected " + expected(setting);
}

std::string refusal(const FilterSetting& setting, const std::string& value) {
  return "is " + in_quotes(value) + ", expected " + expected(setting, value);
}
template <typename T>
std::string refusal(const FilterSetting& setting, const T&) {
  return "expected " + expected(setting);
}

template <typename T>
Option add(const Command& command, const FilterSetting& setting, FilterChoice& choice) {
  if constexpr (std::is_same_v<T, bool>) {
    return command.add_flag_taken(
        setting.option,
        [&setting, &choice] {
          const bool usual = std::get<bool>(value_of(setting, FilterSettings{}));
          static_cast<void>(choose(setting, !usual, choice));
        },
        help(setting));
  } else {
    return command
        .add_taken<Read<T>>(
            setting.option,
            [&setting, &choice](const Read<T>& value) {
              if (!choose(setting, value, choice)) throw WrongUsage(setting.option, refusal(setting, value));
            },
            help(setting))
        .check([&setting](const std::string& text) {
          if constexpr (std::is_same_v<T, std::string>)
            return wrong_name(setting, text);
          else
            return wrong_number<T>(setting, text);
        });
  }
}

}  // namespace

void add_filter_options(const Command& command, FilterChoice& choice, bool with_rule) {
  for (const FilterSetting& setting : filter_table()) {
    if (!with_rule && setting.key == std::string_view("rule")) continue;
    const Option option =
        std::visit([&]<typename T>(const SettingMember<T>&) { return add<T>(command, setting, choice); },
                   setting.member);
    option.group("Filter");
    if (setting.key == std::string_view("state_parameters")) option.delimiter(',');
  }
}

}  // namespace ifog::tools
