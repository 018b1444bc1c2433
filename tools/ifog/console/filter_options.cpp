// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/filter_options.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <string_view>
#include <type_traits>

#include "filters/settings/filter_table.h"

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
    return app.add_option_function<Read<T>>(
        setting.option,
        [&setting, &choice](const Read<T>& value) {
          if (!choose(setting, value, choice))
            throw CLI::ValidationError(setting.option, "expected " + expected(setting));
        },
        help(setting));
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
