// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/filter_options.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <string_view>
#include <type_traits>

#include "drivers/ifog/quoted.h"
#include "filters/rules/names.h"
#include "filters/settings/filter_table.h"
#include "tools/ifog/console/checked_values.h"

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
    std::int64_t value = 0;
    good = good && CLI::detail::lexical_cast(text, value) && choose(setting, value, ignored);
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
CLI::Option* add(CLI::App& app, const FilterSetting& setting, FilterChoice& choice) {
  if constexpr (std::is_same_v<T, bool>) {
    return app.add_flag_callback(
        setting.option,
        [&setting, &choice] {
          const bool usual = std::get<bool>(value_of(setting, FilterSettings{}));
          static_cast<void>(choose(setting, !usual, choice));
        },
        help(setting));
  } else {
    CLI::Option* const option = app.add_option_function<Read<T>>(
        setting.option,
        [&setting, &choice](const Read<T>& value) {
          if (!choose(setting, value, choice))
            throw CLI::ValidationError(setting.option, refusal(setting, value));
        },
        help(setting));
    return option->check([&setting](const std::string& text) {
      if constexpr (std::is_same_v<T, std::string>)
        return wrong_name(setting, text);
      else
        return wrong_number<T>(setting, text);
    });
  }
}

}  // namespace

void add_filter_options(CLI::App& app, FilterChoice& choice, bool with_rule) {
  for (const FilterSetting& setting : filter_table()) {
    if (!with_rule && setting.key == std::string_view("rule")) continue;
    CLI::Option* const option = std::visit(
        [&]<typename T>(const SettingMember<T>&) { return add<T>(app, setting, choice); }, setting.member);
    option->group("Filter");
    if (setting.key == std::string_view("state_parameters")) option->delimiter(',');
  }
}

}  // namespace ifog::tools
