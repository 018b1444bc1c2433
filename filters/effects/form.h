// SPDX-License-Identifier: Apache-2.0
// The forms an effect can take: how a channel, or time alone, turns into an error of the rate.
//
// With c the channel less its reference, tau time constants, LP the first-order low-pass:
//   linear        c
//   quadratic     c^2;  cubic c^3;  quintic c^5;  septic c^7
//   rate          d/dt LP(c);  second_rate d2/dt2 LP(LP(c))
//   lagged        LP(c), or LP(LP(c)) with two time constants
//   lookup        f(c), piecewise linear; with `angle` the table is an angle and the effect its difference over dt
//   product       c * with_form(with_channel)
//   band_power    mean square of c - LP(c)
//   absolute      |c|
//   cosine, sine  of 2 pi c/period, the channel an angle: once a turn, or a whole part of it
//   transition    tanh(c / half width), c counted from its middle: from one level to another
//   dead_zone     c where |c| is below the half width, else 0
// and of the time t since the record's start (or the daemon's):
//   line          a cos 2 pi f t + b sin 2 pi f t
//   step          0 before t0, 1 from there on
//   rate_ramp     t
//   warm_up       exp(-t/tau)
//   rebuilt_ramp  a closed loop's feedback ramp, its phase rebuilt from the angle turned; see ramp_tracker.h
//   bias          1, known where there was a reference rate
// earth_rate is the Earth's rate turning into a tilting gyro's axis; on one heading it is linear in
// acceleration. gauss_markov, outliers, noise_change, quantisation say what the noise is; there is nothing to
// subtract.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "filters/model_file/channel_names.h"
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

std::optional<Form> form_named(std::string_view name);
std::string_view name_of(Form form);

[[nodiscard]] bool has_channel(Form form);
[[nodiscard]] bool has_memory(
    Form form);  // depends on the channel's past, so it cannot be a function of the rate
[[nodiscard]] bool describes_noise(Form form);  // nothing to subtract
[[nodiscard]] bool is_of_time(Form form);       // a function of time alone that is subtracted

// Whether it is corrected online; see is_corrected() in filters/model_file/effect_parameters.h.
[[nodiscard]] bool carries_over(Form form);

// The power of a polynomial form, 0 for others.
[[nodiscard]] int power_of(Form form);

// 0 when the effect has no parameter of that name.
[[nodiscard]] double parameter(const Effect& effect, std::string_view name);

// Parameter of a dead zone or a transition besides the coefficient, in the channel's unit.
inline constexpr std::string_view kHalfWidth = "half_width";

// What a form's time constant is called: "lag_s" of lagged, "time_constant_s" of warm_up, "bandwidth_s" of
// the others.
[[nodiscard]] std::string_view time_constant_name(Form form);
// Name of the time constant; a product's is that of its second factor.
[[nodiscard]] std::string_view time_constant_name(const Effect& effect);
// Name of the second time constant of a form that may have one: "average_s" of band_power, "second_lag_s" of
// lagged.
[[nodiscard]] std::string_view second_time_constant_name(Form form);
[[nodiscard]] std::string_view second_time_constant_name(const Effect& effect);

// The measured rate of an axis of the same sensor as a channel: "rate_y_radps" for "y".
[[nodiscard]] std::string rate_of_axis(std::string_view axis);
[[nodiscard]] std::string axis_of_rate(std::string_view channel);  // "" when the channel is none

// The reference rate, known on a rate table; online the rate itself replaces it.
[[nodiscard]] bool is_reference_rate(std::string_view channel);

// Under this name a model's ranges say for how long after a record's start a ramp in time was fitted.
inline constexpr std::string_view kTimeRange = "time_s";

}  // namespace ifog
