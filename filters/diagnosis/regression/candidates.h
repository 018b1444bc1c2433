// SPDX-License-Identifier: Apache-2.0
// What the diagnosis tries: every form on every channel, with coarse grids of time constants that are refined
// for those that do well.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "filters/diagnosis/regression/whitening.h"

namespace ifog {

// What an effect is by its first reading: an error; the Earth's rate turning into an axis that tilts, which
// is rotation; or a channel that stands for another one, by a coefficient that no gyro has. Rotation and
// proxies are shown, and subtracted only when asked for.
enum class FirstReading { kError, kEarthRateShown, kEarthRateSubtracted, kProxyShown };

struct Candidate {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  Form form = Form::kLinear;
  std::size_t channel = kNone;
  Form with_form = Form::kLinear;  // product
  std::size_t with_channel = kNone;
  double time_constant_s = 0.0;         // rate, second_rate, lagged, band_power, warm_up
  double second_time_constant_s = 0.0;  // lagged, band_power
  double time_s = 0.0;                  // step: block time in its record
  std::size_t record = 0;               // step: where it is
  double period = 0.0;                  // cosine, sine
  double centre = 0.0;                  // transition: the channel's value in its middle
  double half_width = 0.0;  // transition; dead_zone, which no search tries, see residual/dead_zone.h
  double of_channel = 0.0;  // what its channel adds to the complexity: one that no logger wrote
  FirstReading first_reading = FirstReading::kError;

  [[nodiscard]] bool searched() const { return time_constant_s > 0.0 || is_transition(); }
  [[nodiscard]] bool is_transition() const { return form == Form::kTransition; }
  [[nodiscard]] bool is_periodic() const { return form == Form::kCosine || form == Form::kSine; }
  // A cosine and a sine of one period are one swing, of unknown phase.
  [[nodiscard]] bool swings_with(const Candidate& other) const {
    return is_periodic() && other.is_periodic() && form != other.form && channel == other.channel &&
           period == other.period;
  }
  [[nodiscard]] bool uses(std::size_t of) const { return channel == of || with_channel == of; }
  // Whether the model will take it away, in this record and the next.
  [[nodiscard]] bool corrected() const { return carries_over(form) && !shown(); }
  [[nodiscard]] bool shown() const {
    return first_reading == FirstReading::kEarthRateShown || first_reading == FirstReading::kProxyShown;
  }
  [[nodiscard]] bool is_earth_rate() const {
    return first_reading == FirstReading::kEarthRateShown ||
           first_reading == FirstReading::kEarthRateSubtracted;
  }
  [[nodiscard]] bool same_shape(
      const Candidate& other) const;  // but for time constants and where a transition is
};

// Whether one of the effects has the shape of this one.
bool has_shape(std::span<const Candidate> effects, const Candidate& wanted);

// Time constants a form is tried with: from a few samples to an hour, and never longer than the record can
// show.
std::vector<double> time_constants(const BlockGrid& grid, Form form);

// Only forms that a channel can have are tried: no powers of a switch, only periodic forms of an angle, the
// misalignment of another axis' rate where that axis was turned, and transitions of temperatures alone. lookup is
// not among them: a table of a channel has a coefficient a knot, and polynomials to the cubic say what a few knots
// would (the feedback ramp's table is fitted in ramp.h). Neither are steps, which scan.h places, nor lines,
// which lines.h finds in samples, nor the forms that have nothing to subtract; earth_rate is the same regressor
// as acceleration, see findings.cpp.
std::vector<Candidate> library(const BlockData& data);

// Light that reaches the detector by a second path, over a splice, a connector or the wrong polarisation,
// interferes with the rest, and the bias swings as the temperature changes the difference of the paths: a
// fringe of a period that no maker tells. They are tried this far apart.
inline constexpr double kStepOfFringes = 0.5;  // of fringes within the range: neighbours correlate by 0.7
bool is_fringe(const BlockData& data, const Candidate& candidate);

// Two effects that are one law together, each of which may be hidden while the other is missing: a law about
// a point that nobody knows, k (c - c0)^2, k g (c - c0) while a switch g is on, or k w (c - c0) of a scale
// factor, a swing of unknown phase, a fringe, and the power of vibration in one band.
struct NaturalPair {
  Candidate first, second;
};
std::vector<NaturalPair> natural_pairs(const BlockData& data);

// Products of a channel with the others, worth trying once the channel has an effect of its own: the effect's
// size may depend on a second channel.
std::vector<Candidate> products_of(const BlockData& data, std::size_t channel);

// The regressor of an effect, in the unit of the form's value.
Eigen::VectorXd regressor(const BlockData& data, const Candidate& candidate);

// Preference in units of twice the log-likelihood: of two that fit alike the plainer one is chosen.
double complexity(const Candidate& candidate);

// With names, references and units, coefficients still zero.
Effect effect_of(const BlockData& data, const Candidate& candidate);
// The other way. None of what has no regressor of its own (a table, a rebuilt ramp, a line, a noise term), or where
// the data lacks a channel of it.
std::optional<Candidate> candidate_of(const BlockData& data, const Effect& effect);

}  // namespace ifog
