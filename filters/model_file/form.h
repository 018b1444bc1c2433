// SPDX-License-Identifier: Apache-2.0
// Forms of effects: how a channel, or time, causes an error of the rate.
//
// With c the channel minus its reference, tau time constants, LP the first-order low-pass:
//   linear        c
//   quadratic     c^2;  cubic c^3;  quintic c^5;  septic c^7
//   rate          d/dt LP(c);  second_rate d2/dt2 LP(LP(c))
//   lagged        LP(c), or LP(LP(c)) with two time constants
//   lookup        f(c), piecewise linear; with `angle` the table is an angle, the effect its difference / dt
//   product       c * with_form(with_channel)
//   band_power    mean square of c - LP(c)
//   absolute      |c|
//   cosine, sine  of 2 pi c/period; the channel is an angle, the period a turn or a fraction of it
//   transition    tanh(c / half width), c relative to its centre: change from one level to another
//   dead_zone     c if |c| is below the half width, else 0
// and with t the time since the record's start (or the daemon's):
//   line          a cos 2 pi f t + b sin 2 pi f t
//   step          0 before t0, then 1
//   rate_ramp     t
//   warm_up       exp(-t/tau)
//   rebuilt_ramp  feedback ramp of a closed loop, its phase rebuilt from the turned angle; see ramp_tracker.h
//   bias          1, known with a reference rate
// earth_rate is the Earth's rate in a tilting gyro; on one heading it is linear in acceleration.
// gauss_markov, outliers, noise_change, quantisation describe the noise and are not subtracted.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

enum class Form {
  kLinear,
  kQuadratic,
  kCubic,
  kQuintic,
  kSeptic,
  kRate,
  kSecondRate,
  kLagged,
  kLookup,
  kProduct,
  kAbsolute,
  kCosine,
  kSine,
  kBandPower,
  kTransition,
  kDeadZone,
  kLine,
  kStep,
  kRateRamp,
  kWarmUp,
  kBias,
  kRebuiltRamp,
  kEarthRate,
  kGaussMarkov,
  kOutliers,
  kNoiseChange,
  kQuantisation,
};

struct ParameterRule {
  enum class Values { kAny, kNotNegative, kPositive, kNotZero };
  std::string_view name;
  bool needed = false;
  Values values = Values::kAny;
};

struct FormRules {
  Form form;
  std::string_view name;
  std::vector<ParameterRule>
      parameters;  // in a model file; unknown ones are errors, as they would be ignored silently
};

// In the order of Form.
const std::vector<FormRules>& form_rules();
std::optional<Form> form_named(std::string_view name);
std::string_view name_of(Form form);

// Parameters of an effect; a product has its second form's in addition to its coefficient.
std::vector<ParameterRule> parameters_of(Form form, std::optional<Form> with_form);
[[nodiscard]] bool allows(const ParameterRule& rule, double value);
std::string expected(const ParameterRule& rule);  // expected value: "a number above 0"

[[nodiscard]] bool has_channel(Form form);
// Depends on the channel's past, so it cannot be a function of the rate.
[[nodiscard]] bool has_memory(Form form);
[[nodiscard]] bool is_of_angle(Form form) noexcept;  // cosine, sine
[[nodiscard]] bool may_be_factor(Form form);         // the second of a product
[[nodiscard]] bool describes_noise(Form form);       // not subtracted; parameters of any name
[[nodiscard]] bool is_of_time(Form form);            // a function of time that is subtracted

// True if effects of this form are corrected online. False for single events, effects whose phase the next
// record does not share, dead zones (the rotation is lost) and descriptions of noise. A warm-up is corrected
// if the time since power-up is known. Of a time ramp the slope is corrected; its origin is part of the bias.
[[nodiscard]] bool carries_over(Form form);

// Power of a polynomial form, 0 for others.
[[nodiscard]] int power_of(Form form);

// Value of the effect's parameter of this name, or 0.
[[nodiscard]] double parameter(const Effect& effect, std::string_view name);

// Parameter of a dead zone or transition in addition to the coefficient, in the channel's unit.
inline constexpr std::string_view kHalfWidth = "half_width";

// Name of a form's time constant: "lag_s" of lagged, "time_constant_s" of warm_up, "bandwidth_s" of others.
[[nodiscard]] std::string_view time_constant_name(Form form);
// The same for an effect; a product's is that of its second factor.
[[nodiscard]] std::string_view time_constant_name(const Effect& effect);
// Name of a possible second time constant: "average_s" of band_power, "second_lag_s" of lagged.
[[nodiscard]] std::string_view second_time_constant_name(Form form);
[[nodiscard]] std::string_view second_time_constant_name(const Effect& effect);

// Channel name of another axis's measured rate: "rate_y_radps" for "y".
[[nodiscard]] std::string rate_of_axis(std::string_view axis);
[[nodiscard]] std::string axis_of_rate(std::string_view channel);  // inverse; "" for other channels

// The reference rate of a rate table; online the rate itself replaces it.
[[nodiscard]] bool is_reference_rate(std::string_view channel);

// Name, in a model's ranges, of the time after a record's start over which a ramp was fitted.
inline constexpr std::string_view kTimeRange = "time_s";

}  // namespace ifog
