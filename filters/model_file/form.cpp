// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/form.h"

#include <algorithm>

namespace ifog {
namespace {

using Values = ParameterRule::Values;

constexpr ParameterRule kCoefficient{"coefficient", true, Values::kAny};
// 0: not smoothed.
constexpr ParameterRule kBandwidth{"bandwidth_s", true, Values::kNotNegative};
// Extrapolation range of a power before its tangent is used (filters/effects/reach.h).
constexpr ParameterRule kCurve{"curve_reach", false, Values::kNotNegative};
constexpr ParameterRule kRmsOfTable{"angle_rms", false, Values::kNotNegative};

}  // namespace

const std::vector<FormRules>& form_rules() {
  static const std::vector<FormRules> rules = {
      {Form::kLinear, "linear", {kCoefficient}},
      {Form::kQuadratic, "quadratic", {kCoefficient, kCurve}},
      {Form::kCubic, "cubic", {kCoefficient, kCurve}},
      {Form::kQuintic, "quintic", {kCoefficient, kCurve}},
      {Form::kSeptic, "septic", {kCoefficient, kCurve}},
      {Form::kRate, "rate", {kCoefficient, kBandwidth}},
      {Form::kSecondRate, "second_rate", {kCoefficient, kBandwidth}},
      {Form::kLagged,
       "lagged",
       {kCoefficient, {"lag_s", true, Values::kPositive}, {"second_lag_s", false, Values::kNotNegative}}},
      {Form::kLookup, "lookup", {kRmsOfTable}},
      {Form::kProduct, "product", {kCoefficient}},
      {Form::kAbsolute, "absolute", {kCoefficient}},
      {Form::kCosine, "cosine", {kCoefficient}},
      {Form::kSine, "sine", {kCoefficient}},
      // With 0 the low-pass equals the channel, and the power is zero.
      {Form::kBandPower,
       "band_power",
       {kCoefficient, {"bandwidth_s", true, Values::kPositive}, {"average_s", false, Values::kNotNegative}}},
      {Form::kTransition, "transition", {kCoefficient, {"half_width", true, Values::kPositive}}},
      {Form::kDeadZone, "dead_zone", {{"coefficient"}, {"half_width", true, Values::kNotNegative}}},
      {Form::kLine, "line", {{"cosine"}, {"sine"}, {"frequency_hz", false, Values::kNotNegative}}},
      {Form::kStep, "step", {{"coefficient"}, {"time_s"}}},
      {Form::kRateRamp, "rate_ramp", {kCoefficient}},
      {Form::kWarmUp, "warm_up", {kCoefficient, {"time_constant_s", true, Values::kPositive}}},
      {Form::kBias, "bias", {kCoefficient}},
      {Form::kRebuiltRamp,
       "rebuilt_ramp",
       {{"cycles_per_rad", true, Values::kNotZero},
        {"noise_density", true, Values::kPositive},
        {"phase_walk", true, Values::kNotNegative},
        kRmsOfTable}},
      {Form::kEarthRate, "earth_rate", {kCoefficient}},
      {Form::kGaussMarkov, "gauss_markov", {}},
      {Form::kOutliers, "outliers", {}},
      {Form::kNoiseChange, "noise_change", {}},
      {Form::kQuantisation, "quantisation", {}}};
  return rules;
}

std::optional<Form> form_named(std::string_view name) {
  const auto found = std::ranges::find(form_rules(), name, &FormRules::name);
  return found == form_rules().end() ? std::nullopt : std::optional(found->form);
}

std::string_view name_of(Form form) { return form_rules()[static_cast<std::size_t>(form)].name; }

std::vector<ParameterRule> parameters_of(Form form, std::optional<Form> with_form) {
  std::vector<ParameterRule> all = form_rules()[static_cast<std::size_t>(form)].parameters;
  if (form == Form::kProduct && with_form)
    for (const ParameterRule& rule : parameters_of(*with_form, {}))
      if (rule.name != kCoefficient.name) all.push_back(rule);
  return all;
}

bool allows(const ParameterRule& rule, double value) {
  switch (rule.values) {
    case Values::kNotNegative:
      return value >= 0.0;
    case Values::kPositive:
      return value > 0.0;
    case Values::kNotZero:
      return value != 0.0;
    case Values::kAny:
      break;
  }
  return true;
}

std::string expected(const ParameterRule& rule) {
  switch (rule.values) {
    case Values::kNotNegative:
      return "a number of at least 0";
    case Values::kPositive:
      return "a number above 0";
    case Values::kNotZero:
      return "a number other than 0";
    case Values::kAny:
      break;
  }
  return "a number";
}

bool has_channel(Form form) { return form < Form::kLine || form == Form::kEarthRate; }

bool has_memory(Form form) {
  return form == Form::kRate || form == Form::kSecondRate || form == Form::kLagged ||
         form == Form::kBandPower;
}

bool is_of_angle(Form form) noexcept { return form == Form::kCosine || form == Form::kSine; }

bool may_be_factor(Form form) {
  return has_channel(form) && form != Form::kLookup && form != Form::kProduct && !is_of_angle(form);
}

bool describes_noise(Form form) { return form >= Form::kGaussMarkov; }

bool is_of_time(Form form) { return form == Form::kWarmUp || form == Form::kRateRamp || form == Form::kBias; }

bool carries_over(Form form) {
  return form != Form::kDeadZone && form != Form::kLine && form != Form::kStep && !describes_noise(form);
}

int power_of(Form form) {
  switch (form) {
    case Form::kLinear:
    case Form::kEarthRate:
      return 1;
    case Form::kQuadratic:
      return 2;
    case Form::kCubic:
      return 3;
    case Form::kQuintic:
      return 5;
    case Form::kSeptic:
      return 7;
    default:
      return 0;
  }
}

double parameter(const Effect& effect, std::string_view name) {
  for (const ModelParameter& each : effect.parameters) {
    if (each.name == name) return each.value;
  }
  return 0.0;
}

std::string_view time_constant_name(Form form) {
  if (form == Form::kLagged) return "lag_s";
  return form == Form::kWarmUp ? "time_constant_s" : "bandwidth_s";
}

namespace {

Form form_with_memory(const Effect& effect) {
  return form_named(effect.with_form.empty() ? effect.form : effect.with_form).value_or(Form::kRate);
}

}  // namespace

std::string_view time_constant_name(const Effect& effect) {
  return time_constant_name(form_with_memory(effect));
}

std::string_view second_time_constant_name(Form form) {
  return form == Form::kBandPower ? "average_s" : "second_lag_s";
}

std::string_view second_time_constant_name(const Effect& effect) {
  return second_time_constant_name(form_with_memory(effect));
}

std::string rate_of_axis(std::string_view axis) {
  return axis.empty() ? "rate_radps" : "rate_" + std::string(axis) + "_radps";
}

std::string axis_of_rate(std::string_view channel) {
  constexpr std::string_view kBefore = "rate_";
  constexpr std::string_view kAfter = "_radps";
  if (!channel.starts_with(kBefore) || !channel.ends_with(kAfter)) return "";
  if (channel.size() <= kBefore.size() + kAfter.size()) return "";
  return std::string(channel.substr(kBefore.size(), channel.size() - kBefore.size() - kAfter.size()));
}

bool is_reference_rate(std::string_view channel) { return channel.starts_with("reference_rate"); }

}  // namespace ifog
