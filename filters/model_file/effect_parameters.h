// SPDX-License-Identifier: Apache-2.0
// Parameters that each form has in a model file. Unknown ones are errors, as they would be ignored silently.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ifog {

struct ParameterRule {
  enum class Values { kAny, kNotNegative, kPositive, kNotZero };
  std::string_view name;
  bool needed = false;
  Values values = Values::kAny;
};

struct FormRules {
  std::string_view form;
  std::vector<ParameterRule> parameters;
  bool open = false;  // describes noise for users: parameters of any name
};

const std::vector<FormRules>& form_rules();
// Null for an unknown form.
const FormRules* rules_of_form(std::string_view form);

// True if effects of this form are corrected online. False for single events, effects whose phase the next
// record does not share, dead zones (the rotation is lost) and descriptions of noise. A warm-up is corrected
// if the time since power-up is known. Of a time ramp the slope is corrected; its origin is part of the bias.
[[nodiscard]] bool is_corrected(std::string_view form);
// True if the form needs a channel.
[[nodiscard]] bool is_of_channel(std::string_view form);
// Forms of a product's second factor.
const std::vector<std::string_view>& forms_of_product();

// Parameters of an effect; a product has its second form's in addition to its coefficient.
std::vector<ParameterRule> parameters_of(std::string_view form, std::string_view with_form);

[[nodiscard]] bool allows(const ParameterRule& rule, double value);
std::string expected(const ParameterRule& rule);  // expected value: "a number above 0"

}  // namespace ifog
