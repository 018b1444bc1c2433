// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/form.h"

#include <array>
#include <utility>

#include "filters/model_file/effect_parameters.h"

namespace ifog {
namespace {

constexpr std::array<std::pair<Form, std::string_view>, 27> kNames = {{
    {Form::kLinear, "linear"},
    {Form::kQuadratic, "quadratic"},
    {Form::kCubic, "cubic"},
    {Form::kQuintic, "quintic"},
    {Form::kSeptic, "septic"},
    {Form::kRate, "rate"},
    {Form::kSecondRate, "second_rate"},
    {Form::kLagged, "lagged"},
    {Form::kLookup, "lookup"},
    {Form::kProduct, "product"},
    {Form::kAbsolute, "absolute"},
    {Form::kCosine, "cosine"},
    {Form::kSine, "sine"},
    {Form::kBandPower, "band_power"},
    {Form::kTransition, "transition"},
    {Form::kDeadZone, "dead_zone"},
    {Form::kLine, "line"},
    {Form::kStep, "step"},
    {Form::kRateRamp, "rate_ramp"},
    {Form::kWarmUp, "warm_up"},
    {Form::kBias, "bias"},
    {Form::kRebuiltRamp, "rebuilt_ramp"},
    {Form::kEarthRate, "earth_rate"},
    {Form::kGaussMarkov, "gauss_markov"},
    {Form::kOutliers, "outliers"},
    {Form::kNoiseChange, "noise_change"},
    {Form::kQuantisation, "quantisation"},
}};

}  // namespace

std::optional<Form> form_named(std::string_view name) {
  for (const auto& [form, text] : kNames) {
    if (text == name) return form;
  }
  return std::nullopt;
}

std::string_view name_of(Form form) {
  for (const auto& [each, text] : kNames) {
    if (each == form) return text;
  }
  return "";
}

bool has_channel(Form form) { return form < Form::kLine || form == Form::kEarthRate; }

bool has_memory(Form form) {
  return form == Form::kRate || form == Form::kSecondRate || form == Form::kLagged ||
         form == Form::kBandPower;
}

bool describes_noise(Form form) { return form >= Form::kGaussMarkov; }

bool is_of_time(Form form) { return form == Form::kWarmUp || form == Form::kRateRamp || form == Form::kBias; }

bool carries_over(Form form) { return is_corrected(name_of(form)); }

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
