// SPDX-License-Identifier: Apache-2.0
// One form applied to one channel, as causal code: the value per unit of the effect's coefficient, sample by
// sample. The regressors of the diagnosis and the corrections of the daemon both come from here, so that what
// was fitted is what is subtracted.
#pragma once

#include <vector>

#include "filters/effects/form.h"
#include "filters/effects/reach.h"

namespace ifog {

// Mean square is an average; where a model does not say of how long, a second is short against what the
// filter behind it follows and long against vibration.
inline constexpr double kPowerAverage_s = 1.0;

struct ShapeSettings {
  Form form = Form::kLinear;
  double reference = 0.0;        // the channel's value at which the shape is zero
  double time_constant_s = 0.0;  // rate, second_rate, lagged, band_power, warm_up; 0: no smoothing
  // lagged: a second stage; band_power: what the power is averaged over, 0: a second.
  double second_time_constant_s = 0.0;
  // band_power: what vibrates was not always at its first sample, so the low-pass begins as the mean so far.
  // A model without average_s was fitted to a shape that began with that sample, and is read so.
  bool begins_at_mean = false;
  std::vector<double> table_x, table_y;  // lookup
  double period = 0.0;                   // lookup (0: not periodic), cosine, sine
  double half_width = 0.0;               // dead_zone, transition; of a power above one its curve_reach
  bool angle = false;
  // cosine, sine: of no angle, as a fringe of a temperature. A law without a period continues as a polynomial does.
  bool fringe = false;
  double elapsed_s = 0.0;  // warm_up: since power-up at the first sample
};

ShapeSettings shape_settings(
    const Effect& effect);  // of the effect's own channel; "product": its linear first factor
ShapeSettings with_shape_settings(const Effect& effect);  // "product": the second factor

// Mean of a dead zone's value over what is spread evenly about `mean` with that variance, as a rate is that
// passes through the zone while it is averaged.
double mean_in_dead_zone(double mean, double variance, double half_width) noexcept;

class Shape {
 public:
  // Throws std::invalid_argument for a lookup without a table, a cosine or sine without a period, a
  // transition without a width, a negative time constant or half width, or a form without a channel other
  // than warm_up and rate_ramp.
  explicit Shape(ShapeSettings settings);

  // One sample: the channel's value, and the time it covers. The first sample sets the low-pass to itself, as
  // if the channel had always been there; a rate_ramp is the time since it. No allocation, no exception.
  double step(double value, double dt_s) noexcept;
  // A step of several samples, by their mean and their variance about it: as its samples in turn would, for
  // quadratic and band_power.
  double step_over(double value, double scatter, double dt_s) noexcept;
  void restart() noexcept { started_ = false; }
  // For a warm_up, before its first sample: ShapeSettings::elapsed_s.
  void begin(double elapsed_s) noexcept { settings_.elapsed_s = elapsed_s; }

  // One sample of a channel that may have left the range the shape was fitted on; see reach.h.
  double step(const Reach& channel, double dt_s) noexcept;

  // Value of a form without memory at one value of the channel.
  [[nodiscard]] double at(double value) const noexcept;
  // Likewise, going on beyond the range as far as a fit may.
  [[nodiscard]] double at(const Reach& channel) const noexcept;
  // By how much the shape may be wrong outside the range, per unit of its coefficient: what it does not
  // follow, of a higher power the difference between the power and its tangent, and of a transition what it
  // has still gone.
  [[nodiscard]] double left_behind(const Reach& channel) const noexcept;
  // Likewise by a curvature that the fit could not see, per unit of the coefficient's standard error. Over a
  // range of width S evenly visited a linear term is known to s/(S sqrt(n/12)) and a quadratic one,
  // orthogonal to it, to s/(S^2 sqrt(n/180)): sqrt(15)/S times as well. By x beyond the edge it has grown by
  // S x + x^2.
  [[nodiscard]] double unseen_curvature(const Reach& channel) const noexcept;

  [[nodiscard]] const ShapeSettings& settings() const noexcept { return settings_; }
  // A step leaves something for the next: of the channel's past, or of time.
  [[nodiscard]] bool has_state() const noexcept { return has_state_; }
  // The same shape of another compensator continues where that one is. False when it is not the same shape.
  bool take_over(const Shape& previous) noexcept;

 private:
  [[nodiscard]] double table(double value) const noexcept;
  [[nodiscard]] double slope(double value) const noexcept;
  [[nodiscard]] bool goes_on() const noexcept { return settings_.form != Form::kLookup; }

  // What a step reads stands together.
  double first_ = 0.0, second_ = 0.0, elapsed_ = 0.0, dt_ = 0.0, alpha_ = 1.0, beta_ = 1.0;
  bool started_ = false;
  bool has_state_ = false, bounded_ = false;
  int power_ = 0;  // power_of() the form
  ShapeSettings settings_;
};

}  // namespace ifog
