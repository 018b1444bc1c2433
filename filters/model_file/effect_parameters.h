// SPDX-License-Identifier: Apache-2.0
// Which parameters the effect of a form has in a model file. What a form does not know would be read and
// correct nothing, in silence.
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
  bool open = false;  // what it says of the noise is for people: parameters of any name
};

const std::vector<FormRules>& form_rules();
// Null for a form that nobody knows.
const FormRules* rules_of_form(std::string_view form);

// False for what happened once in a record, or has a phase that the next record does not share: it is
// reported and not corrected online. So is a dead zone: what the sensor did not see nobody can give back; and
// what only says of the noise. A warm-up's origin is power-up, so it is corrected where that is known. Of a
// ramp in time the slope carries over, and where it began is a part of the bias.
[[nodiscard]] bool is_corrected(std::string_view form);
// Whether an effect of this form is of a channel, without which nothing can be subtracted.
[[nodiscard]] bool is_of_channel(std::string_view form);
// What a product can be with, besides its own channel.
const std::vector<std::string_view>& forms_of_product();

// Parameters of an effect; a product has its second form's besides its coefficient.
std::vector<ParameterRule> parameters_of(std::string_view form, std::string_view with_form);

[[nodiscard]] bool allows(const ParameterRule& rule, double value);
std::string expected(const ParameterRule& rule);  // of its value: "a number above 0"

}  // namespace ifog
