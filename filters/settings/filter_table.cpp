// SPDX-License-Identifier: Apache-2.0
#include "filters/settings/filter_table.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <type_traits>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Limits within which fourth powers of normalised innovations are finite.
constexpr double kMostNoise = 1e12, kLeastMeasurementNoise = 1e-60;

using S = FilterSettings;
using C = FilterChoice;

constexpr std::array kWideband{"motion", "noise"};
constexpr std::array kWeights{"kept", "fresh", "uniform"};

constexpr std::array kTable{
    FilterSetting{"rule",
                  "--filter",
                  SettingMember<std::string>{&S::rule, &C::rule},
                  {},
                  {},
                  "",
                  "adaptation rule: ckf, irwe-akfg, iae, rae, mmae, sage-husa or vb"},
    FilterSetting{
        "state",
        "--state",
        SettingMember<std::string>{&S::state, &C::state},
        {},
        {},
        "",
        "state model: random-walk, integrated-random-walk, gauss-markov, ar(p), arma(p,q), harmonic, or "
        "a sum of them with ' + '"},
    FilterSetting{"process_noise",
                  "--process-noise",
                  SettingMember<double>{&S::process_noise, &C::process_noise},
                  {0.0, kMostNoise},
                  {},
                  "(rad/s)^2/s",
                  "driving noise of the state; 0: not given"},
    FilterSetting{"measurement_noise",
                  "--measurement-noise",
                  SettingMember<double>{&S::measurement_noise, &C::measurement_noise},
                  {0.0, kMostNoise, false, kLeastMeasurementNoise},
                  {},
                  "(rad/s)^2",
                  "variance of one sample; 0: not given"},
    FilterSetting{"state_parameters",
                  "--state-parameter",
                  SettingMember<std::vector<double>>{&S::state_parameters, &C::state_parameters},
                  {},
                  {},
                  "",
                  "parameters of the state model, in its own order"},
    FilterSetting{"window",
                  "--window",
                  SettingMember<int>{&S::window, &C::window},
                  {2.0, 100'000.0},
                  {},
                  "samples",
                  "innovations in the adaptive window"},
    FilterSetting{"weights",
                  "--weights",
                  SettingMember<std::string>{&S::weights, &C::weights},
                  {},
                  kWeights,
                  "",
                  "random weights of irwe-akfg"},
    FilterSetting{"wideband",
                  "--wideband",
                  SettingMember<std::string>{&S::wideband, &C::wideband},
                  {},
                  kWideband,
                  "",
                  "what exceeds the known noise: motion (followed) or noise (smoothed)"},
    FilterSetting{"draws",
                  "--draws",
                  SettingMember<int>{&S::draws, &C::draws},
                  {1.0, 1000.0},
                  {},
                  "",
                  "weight draws averaged at each step"},
    FilterSetting{"floor",
                  "--floor",
                  SettingMember<double>{&S::floor, &C::floor},
                  {0.0, 1.0, true},
                  {},
                  "",
                  "floor of the innovation covariance in parts of R; 0: none"},
    FilterSetting{"follow_manoeuvres",
                  "--no-follow",
                  SettingMember<bool>{&S::follow_manoeuvres, &C::follow_manoeuvres},
                  {},
                  {},
                  "",
                  "do not raise the gain after a change of rate"},
    FilterSetting{"conserve_angle",
                  "--no-conserve",
                  SettingMember<bool>{&S::conserve_angle, &C::conserve_angle},
                  {},
                  {},
                  "",
                  "do not return the integral of denoised - compensated after a manoeuvre"},
    FilterSetting{"steady_gain",
                  "--no-steady-gain",
                  SettingMember<bool>{&S::steady_gain, &C::steady_gain},
                  {},
                  {},
                  "",
                  "the rule's window as it is set, not of 1000 samples at least"},
    FilterSetting{"guard",
                  "--no-guard",
                  SettingMember<bool>{&S::guard, &C::guard},
                  {},
                  {},
                  "",
                  "do not restart a filter that has diverged"},
    FilterSetting{
        "plain",
        "--plain",
        SettingMember<bool>{&S::plain, &C::plain},
        {},
        {},
        "",
        "the rule's filter and nothing else: no following, conserving, guard, floor or averaged gain"},
    FilterSetting{"seed",
                  "--seed",
                  SettingMember<std::uint64_t>{&S::seed, &C::seed},
                  {0.0, kInfinity},
                  {},
                  "",
                  "of the random weights"},
};

bool inside(double value, const SettingRange& range) {
  return std::isfinite(value) && value >= range.least &&
         (range.below_most ? value < range.most : value <= range.most) &&
         (range.least_but_zero == 0.0 || value == 0.0 || value >= range.least_but_zero);
}

bool is_among(const std::string& value, std::span<const char* const> choices) {
  for (const char* const choice : choices)
    if (value == choice) return true;
  return choices.empty();
}

// The value as the setting's type if type and range are right.
template <typename T>
std::optional<T> accepted(const FilterSetting& setting, const SettingValue& value) {
  if constexpr (std::is_same_v<T, bool>) {
    if (const bool* const given = std::get_if<bool>(&value)) return *given;
  } else if constexpr (std::is_integral_v<T>) {
    if (const auto* const given = std::get_if<std::int64_t>(&value);
        given != nullptr && inside(static_cast<double>(*given), setting.range))
      return static_cast<T>(*given);
  } else if constexpr (std::is_same_v<T, double>) {
    const auto* const whole = std::get_if<std::int64_t>(&value);
    const auto* const real = std::get_if<double>(&value);
    if (whole == nullptr && real == nullptr) return std::nullopt;
    const double given = whole != nullptr ? static_cast<double>(*whole) : *real;
    if (inside(given, setting.range)) return given;
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (const auto* const given = std::get_if<std::string>(&value);
        given != nullptr && !given->empty() && is_among(*given, setting.choices))
      return *given;
  } else {
    if (const auto* const given = std::get_if<std::vector<double>>(&value)) {
      for (const double item : *given)
        if (!inside(item, setting.range)) return std::nullopt;
      return *given;
    }
  }
  return std::nullopt;
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

std::string as_text(const SettingValue& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>) {
          return v ? "true" : "false";
        } else if constexpr (std::is_same_v<T, std::string>) {
          return in_quotes(v);
        } else if constexpr (std::is_same_v<T, std::vector<double>>) {
          std::string list;
          for (const double item : v) list += (list.empty() ? "" : ", ") + shortest(item);
          return "[" + list + "]";
        } else if constexpr (std::is_same_v<T, double>) {
          return shortest(v);
        } else {
          return std::to_string(v);
        }
      },
      value);
}

std::string in_words(const char* type, const SettingRange& range) {
  std::string out = type;
  if (range.least_but_zero > 0.0) {
    out += " " + shortest(range.least_but_zero) + " ... " + shortest(range.most) + ", or 0";
  } else if (std::isinf(range.most)) {
    if (!std::isinf(range.least)) out += " >= " + shortest(range.least);
  } else if (range.below_most) {
    out += " >= " + shortest(range.least) + " and < " + shortest(range.most);
  } else {
    out += " " + shortest(range.least) + " ... " + shortest(range.most);
  }
  return out;
}

std::string in_words(std::span<const char* const> choices) {
  if (choices.empty()) return "a text in quotes";
  std::string list;
  for (const char* const choice : choices)
    list += (list.empty() ? "\"" : " | \"") + std::string(choice) + "\"";
  return list;
}

template <typename T>
std::string type_and_range(const FilterSetting& setting) {
  if constexpr (std::is_same_v<T, bool>)
    return "true or false";
  else if constexpr (std::is_integral_v<T>)
    return in_words("a whole number", setting.range);
  else if constexpr (std::is_same_v<T, double>)
    return in_words("a number", setting.range);
  else if constexpr (std::is_same_v<T, std::string>)
    return in_words(setting.choices);
  else
    return "a list of numbers";
}

}  // namespace

std::span<const FilterSetting> filter_table() { return kTable; }

std::string expected(const FilterSetting& setting) {
  return std::visit([&]<typename T>(const SettingMember<T>&) { return type_and_range<T>(setting); },
                    setting.member);
}

bool choose(const FilterSetting& setting, const SettingValue& value, FilterChoice& choice) {
  return std::visit(
      [&]<typename T>(const SettingMember<T>& member) {
        std::optional<T> good = accepted<T>(setting, value);
        if (!good) return false;
        choice.*member.choice = std::move(good);
        return true;
      },
      setting.member);
}

SettingValue value_of(const FilterSetting& setting, const FilterSettings& settings) {
  return std::visit(
      [&]<typename T>(const SettingMember<T>& member) -> SettingValue {
        if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>)
          return static_cast<std::int64_t>(settings.*member.setting);
        else
          return settings.*member.setting;
      },
      setting.member);
}

void require_in_range(const FilterSettings& settings) {
  FilterChoice ignored;
  for (const FilterSetting& setting : kTable) {
    const SettingValue value = value_of(setting, settings);
    if (!choose(setting, value, ignored))
      throw std::invalid_argument(std::string(setting.key) + ": " + as_text(value) + ", expected " +
                                  expected(setting));
  }
}

std::string expected(const FilterSetting& setting, const std::string& written) {
  return expected(setting) + did_you_mean(written, setting.choices);
}

FilterSettings settings_in_force(const FilterChoice& choice, FilterSettings base) {
  for (const FilterSetting& setting : kTable)
    std::visit(
        [&](const auto& member) {
          if (choice.*member.choice) base.*member.setting = *(choice.*member.choice);
        },
        setting.member);
  return base;
}

FilterChoice over(const FilterChoice& choice, FilterChoice base) {
  for (const FilterSetting& setting : kTable)
    std::visit(
        [&](const auto& member) {
          if (choice.*member.choice) base.*member.choice = choice.*member.choice;
        },
        setting.member);
  return base;
}

}  // namespace ifog
