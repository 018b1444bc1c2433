// SPDX-License-Identifier: Apache-2.0
// Table of all filter settings, used for [sensor.filter] of the daemon's configuration, [filter] of a model
// file, the command line and the estimator's checks. To add a setting: a member of FilterSettings and of
// FilterChoice, and a row here.
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

// Both limits are included, the upper one unless `below_most`. Infinite: no limit, but the value must be
// finite.
struct SettingRange {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool below_most = false;
  double least_but_zero = 0.0;  // > 0: 0 is allowed, and values of at least this
};

// A value as read from a source. An integer is accepted for a floating-point setting; otherwise types must
// match.
using SettingValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

template <typename T>
struct SettingMember {
  T FilterSettings::*setting;
  std::optional<T> FilterChoice::*choice;
};

struct FilterSetting {
  const char* key;     // key in TOML
  const char* option;  // on the command line; for a boolean, the flag for the value that is not the default
  std::variant<SettingMember<bool>, SettingMember<int>, SettingMember<std::uint64_t>, SettingMember<double>,
               SettingMember<std::string>, SettingMember<std::vector<double>>>
      member;
  SettingRange range;                    // of a number
  std::span<const char* const> choices;  // of a text; empty: names that are defined elsewhere
  const char* unit;                      // "" if none
  const char* help;                      // one line, for the command line
};

// In the order of a model file.
std::span<const FilterSetting> filter_table();

// Type and range as text: "a whole number 2 ... 100000".
std::string expected(const FilterSetting& setting);
// The same with a suggestion for the wrong value `written`.
std::string expected(const FilterSetting& setting, const std::string& written);

// Sets a value of the right type and range; returns false without effect for any other.
[[nodiscard]] bool choose(const FilterSetting& setting, const SettingValue& value, FilterChoice& choice);

SettingValue value_of(const FilterSetting& setting, const FilterSettings& settings);

// Throws std::invalid_argument that names the first setting out of range, its value and what was expected.
// Noise of 0 ("not given") is accepted.
void require_in_range(const FilterSettings& settings);

// `choice`, where given, over `base`.
[[nodiscard]] FilterSettings settings_in_force(const FilterChoice& choice, FilterSettings base);
[[nodiscard]] FilterChoice over(const FilterChoice& choice, FilterChoice base);

}  // namespace ifog
