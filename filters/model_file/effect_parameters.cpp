// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/effect_parameters.h"

#include <algorithm>
#include <array>

namespace ifog {
namespace {

using Values = ParameterRule::Values;

constexpr ParameterRule kCoefficient{"coefficient", true, Values::kAny};
// 0: not smoothed.
constexpr ParameterRule kBandwidth{"bandwidth_s", true, Values::kNotNegative};
// Extrapolation range of a power before its tangent is used (filters/effects/curve_reach.h).
constexpr ParameterRule kCurve{"curve_reach", false, Values::kNotNegative};
constexpr ParameterRule kRmsOfTable{"angle_rms", false, Values::kNotNegative};

}  // namespace

const std::vector<FormRules>& form_rules() {
  static const std::vector<FormRules> rules = {
      {"linear", {kCoefficient}},
      {"quadratic", {kCoefficient, kCurve}},
      {"cubic", {kCoefficient, kCurve}},
      {"quintic", {kCoefficient, kCurve}},
      {"septic", {kCoefficient, kCurve}},
      {"rate", {kCoefficient, kBandwidth}},
      {"second_rate", {kCoefficient, kBandwidth}},
      {"lagged",
       {kCoefficient, {"lag_s", true, Values::kPositive}, {"second_lag_s", false, Values::kNotNegative}}},
      {"lookup", {kRmsOfTable}},
      {"product", {kCoefficient}},
      {"absolute", {kCoefficient}},
      {"cosine", {kCoefficient}},
      {"sine", {kCoefficient}},
      // With 0 the low-pass equals the channel, and the power is zero.
      {"band_power",
       {kCoefficient, {"bandwidth_s", true, Values::kPositive}, {"average_s", false, Values::kNotNegative}}},
      {"transition", {kCoefficient, {"half_width", true, Values::kPositive}}},
      {"dead_zone", {{"coefficient"}, {"half_width", true, Values::kNotNegative}}},
      {"line", {{"cosine"}, {"sine"}, {"frequency_hz", false, Values::kNotNegative}}},
      {"step", {{"coefficient"}, {"time_s"}}},
      {"rate_ramp", {kCoefficient}},
      {"bias", {kCoefficient}},
      {"warm_up", {kCoefficient, {"time_constant_s", true, Values::kPositive}}},
      {"rebuilt_ramp",
       {{"cycles_per_rad", true, Values::kNotZero},
        {"noise_density", true, Values::kPositive},
        {"phase_walk", true, Values::kNotNegative},
        kRmsOfTable}},
      {"earth_rate", {kCoefficient}},
      {"gauss_markov", {}, true},
      {"outliers", {}, true},
      {"noise_change", {}, true},
      {"quantisation", {}, true}};
  return rules;
}

const FormRules* rules_of_form(std::string_view form) {
  for (const FormRules& rules : form_rules())
    if (rules.form == form) return &rules;
  return nullptr;
}

bool is_corrected(std::string_view form) {
  constexpr std::array<std::string_view, 5> kOthers = {"earth_rate", "rate_ramp", "warm_up", "bias",
                                                       "rebuilt_ramp"};
  return is_of_channel(form) || std::find(kOthers.begin(), kOthers.end(), form) != kOthers.end();
}

bool is_of_channel(std::string_view form) {
  constexpr std::array<std::string_view, 15> kForms = {
      "linear", "quadratic", "cubic",    "quintic", "septic", "rate",       "second_rate", "lagged",
      "lookup", "product",   "absolute", "cosine",  "sine",   "band_power", "transition"};
  return std::find(kForms.begin(), kForms.end(), form) != kForms.end();
}

const std::vector<std::string_view>& forms_of_product() {
  static const std::vector<std::string_view> forms = {
      "linear", "quadratic", "cubic",      "quintic",    "septic",    "rate",      "second_rate",
      "lagged", "absolute",  "band_power", "transition", "dead_zone", "earth_rate"};
  return forms;
}

std::vector<ParameterRule> parameters_of(std::string_view form, std::string_view with_form) {
  const FormRules* const own = rules_of_form(form);
  std::vector<ParameterRule> all = own != nullptr ? own->parameters : std::vector<ParameterRule>();
  const FormRules* const second = form == "product" ? rules_of_form(with_form) : nullptr;
  if (second == nullptr) return all;
  for (const ParameterRule& rule : second->parameters)
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

}  // namespace ifog
