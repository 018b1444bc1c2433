// SPDX-License-Identifier: Apache-2.0
// Candidates of the diagnosis: every form on every channel, with coarse grids of time constants, which are
// refined for the best ones.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "filters/diagnosis/regression/whitening.h"

namespace ifog {

// First interpretation of an effect: an error; the Earth's rate in a tilting axis, which is rotation; a proxy
// of another channel, with a coefficient that no gyro has; or a warm-up whose start is long past. Rotation and
// proxies are only shown, unless the options say otherwise.
enum class FirstReading { kError, kEarthRateShown, kEarthRateSubtracted, kProxyShown, kSettlingShown };

struct Candidate {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  Form form = Form::kLinear;
  std::size_t channel = kNone;
  Form with_form = Form::kLinear;  // of a product
  std::size_t with_channel = kNone;
  double time_constant_s = 0.0;         // of rate, second_rate, lagged, band_power, warm_up
  double second_time_constant_s = 0.0;  // of lagged, band_power
  double time_s = 0.0;                  // of a step: block time in its record
  std::size_t record = 0;               // of a step
  double period = 0.0;                  // of cosine, sine
  double centre = 0.0;                  // of a transition: channel value at its centre
  double half_width = 0.0;              // of a transition
  FirstReading first_reading = FirstReading::kError;
  bool smoothed = false;  // time_constant_s is what the noise of the readings needs, and no estimate

  [[nodiscard]] bool searched() const { return time_constant_s > 0.0 || is_transition(); }
  [[nodiscard]] bool is_transition() const { return form == Form::kTransition; }
  [[nodiscard]] bool uses(std::size_t of) const { return channel == of || with_channel == of; }
  // True if the model corrects it in this record and the next.
  [[nodiscard]] bool corrected() const { return carries_over(form) && !shown(); }
  [[nodiscard]] bool shown() const {
    return first_reading != FirstReading::kError && first_reading != FirstReading::kEarthRateSubtracted;
  }
  [[nodiscard]] bool is_earth_rate() const {
    return first_reading == FirstReading::kEarthRateShown ||
           first_reading == FirstReading::kEarthRateSubtracted;
  }
  [[nodiscard]] bool same_shape(
      const Candidate& other) const;  // equal except for time constants and a transition's position
};

// True if one of the effects has the same shape.
bool has_shape(std::span<const Candidate> effects, const Candidate& wanted);

// Time constants tried for a form: from a few samples to an hour, limited by the length of the record.
std::vector<double> time_constants(const BlockGrid& grid, Form form);

// All forms that are possible for each channel: no powers of a switch, only periodic forms of an angle,
// misalignment only to an axis that was turned, transitions only of temperatures. Not included: lookup tables
// (polynomials suffice; the feedback ramp's table is fitted in ramp.h), steps (scan.h), lines (lines.h),
// forms that cannot be subtracted, and earth_rate, which has the regressor of acceleration (findings.cpp).
std::vector<Candidate> library(const BlockData& data);

// A power about a value that its channel never had: within the range it is a line, and a curve only beside one.
bool is_power_beyond(const BlockData& data, const Candidate& candidate);

// Two effects that form one law; each may be hidden without the other. Laws about an unknown point: k (c -
// c0)^2, k g (c - c0) while switch g is on, k w (c - c0) of a scale factor; an error once a turn, of
// unknown phase; vibration power in one band.
struct NaturalPair {
  Candidate first, second;
};
std::vector<NaturalPair> natural_pairs(const BlockData& data);

// Products of a channel with the others, tried after the channel has an effect, whose size may depend on a
// second channel.
std::vector<Candidate> products_of(const BlockData& data, std::size_t channel);

// Not zero for a warm-up of which every record has only the end: the time from power-up to the earliest start
// of a record, s. Its regressor is 1 there instead of at power-up.
double long_past_s(const BlockGrid& grid, const Candidate& candidate);

// Regressor of an effect, in the unit of the form's value.
Eigen::VectorXd regressor(const BlockData& data, const Candidate& candidate);

// Price in units of twice the log-likelihood, by which the simpler of two equally good effects is chosen.
double complexity(const Candidate& candidate);

// Effect with names, references and units; coefficients are zero.
Effect effect_of(const BlockData& data, const Candidate& candidate);
// Inverse of effect_of(). nullopt for forms without a regressor (table, rebuilt ramp, line, noise term) or if
// the data lacks a channel.
std::optional<Candidate> candidate_of(const BlockData& data, const Effect& effect);

}  // namespace ifog
