// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/filter_options.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "filters/rules/names.h"
#include "filters/settings/filter_table.h"
#include "tools/ifog/console/command.h"

namespace ifog::tools {
namespace {

// Type that the command line parses before it is converted.
template <typename T>
using ReadAs = std::conditional_t<std::is_integral_v<T>, std::int64_t, T>;

std::string setting_help(const FilterSetting& setting) {
  std::string out = setting.help;
  if (setting.unit[0] != '\0') out += std::string(", ") + setting.unit;
  const bool ranged = !std::isinf(setting.range.least) || !setting.choices.empty();
  return ranged ? out + "; " + expected(setting) : out;
}

template <typename T>
std::optional<SettingValue> value_in(const std::string& text) {
  if constexpr (std::is_same_v<T, std::string>) return text;
  if constexpr (std::is_integral_v<T>) return whole_in(text);
  return number_in(text);
}

// Returns "" or the error in a value. Names from other tables are checked by expected_name().
template <typename T>
std::string setting_complaint(const FilterSetting& setting, const std::string& text) {
  FilterChoice ignored;
  const std::optional<SettingValue> value = value_in<T>(text);
  std::string wrong;
  if constexpr (std::is_same_v<T, std::string>) wrong = expected_name(setting, text);
  // A list is given in several words; its setting takes all of them.
  const bool listed = std::is_same_v<T, std::vector<double>>;
  if (wrong.empty() && !(value && (listed || choose(setting, *value, ignored))))
    wrong = expected(setting, text);
  return wrong.empty() ? "" : "is " + in_quotes(text) + ", expected " + wrong;
}

template <typename T>
void add_setting(const Command& command, const FilterSetting& setting, FilterChoice& choice) {
  constexpr const char* kGroup = "Filter";
  if constexpr (std::is_same_v<T, bool>) {
    command.add_flag_taken(
        setting.option,
        [&setting, &choice] {
          const bool usual = std::get<bool>(value_of(setting, FilterSettings{}));
          static_cast<void>(choose(setting, !usual, choice));
        },
        setting_help(setting), kGroup);
  } else {
    command.add_taken<ReadAs<T>>(
        setting.option,
        [&setting, &choice](const ReadAs<T>& value) { static_cast<void>(choose(setting, value, choice)); },
        setting_help(setting),
        {.group = kGroup,
         .delimiter = std::is_same_v<T, std::vector<double>> ? ',' : '\0',
         .check = [&setting](const std::string& text) { return setting_complaint<T>(setting, text); }});
  }
}

}  // namespace

void add_filter_options(const Command& command, FilterChoice& choice, bool with_rule) {
  for (const FilterSetting& setting : filter_table()) {
    if (!with_rule && setting.key == std::string_view("rule")) continue;
    std::visit([&]<typename T>(const SettingMember<T>&) { add_setting<T>(command, setting, choice); },
               setting.member);
  }
}

nlohmann::json filter_json(const FilterSettings& settings) {
  nlohmann::json out;
  for (const FilterSetting& setting : filter_table())
    std::visit([&](const auto& member) { out[setting.key] = settings.*member.setting; }, setting.member);
  return out;
}

}  // namespace ifog::tools
