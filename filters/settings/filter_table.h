// SPDX-License-Identifier: Apache-2.0
// The one table of what a filter can be given: [sensor.filter] of the daemon's configuration, [filter] of a
// model file and the options of the command line are read by it, and the estimator holds its settings to it,
// so that no two of them can differ. To add a setting: a member of FilterSettings and of FilterChoice, and a
// row here.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "filters/settings/filter_settings.h"

namespace ifog {

// Both ends allowed, the upper one unless `below_most`. Infinite: no end, though the value is finite.
struct SettingRange {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool below_most = false;
  double least_but_zero = 0.0;  // > 0: 0 is allowed, and what is at least this
};

// A value as a source holds it, before it is narrowed to what the setting takes. A whole number will do for a
// number; nothing else passes for another type.
using SettingValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

template <typename T>
struct SettingMember {
  T FilterSettings::*setting;
  std::optional<T> FilterChoice::*choice;
};

struct FilterSetting {
  const char* key;     // in TOML
  const char* option;  // on the command line; of a boolean, the flag that makes it what it is not by default
  std::variant<SettingMember<bool>, SettingMember<int>, SettingMember<std::uint64_t>, SettingMember<double>,
               SettingMember<std::string>, SettingMember<std::vector<double>>>
      member;
  SettingRange range;                    // of a number
  std::span<const char* const> choices;  // of a text; empty: whatever has that name elsewhere
  const char* unit;                      // "" for none
  const char* help;                      // one line, for the command line
};

// In the order in which a model file holds them.
std::span<const FilterSetting> filter_table();

// Type and range, in words: "a whole number 2 ... 100000".
std::string expected(const FilterSetting& setting);
// The same to who wrote another value: with the choice that is near it.
std::string expected(const FilterSetting& setting, const std::string& written);

// Puts a value of the right type and range into the choice; false, and nothing is done, for any other.
[[nodiscard]] bool choose(const FilterSetting& setting, const SettingValue& value, FilterChoice& choice);

SettingValue value_of(const FilterSetting& setting, const FilterSettings& settings);

// Throws std::invalid_argument naming the first setting that is out of its range, its value and what was
// expected. Noise of 0, "not given", passes: who needs it given says so.
void require_in_range(const FilterSettings& settings);

// What `choice` says, key by key, over `base`.
[[nodiscard]] FilterSettings settings_in_force(const FilterChoice& choice, FilterSettings base);
[[nodiscard]] FilterChoice over(const FilterChoice& choice, FilterChoice base);

}  // namespace ifog
