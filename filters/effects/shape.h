// SPDX-License-Identifier: Apache-2.0
// One form applied to one channel, as causal code: value per unit of the coefficient, sample by sample. Used
// for the diagnosis's regressors and the daemon's correction, so that both agree.
#pragma once

#include <vector>

#include "filters/effects/reach.h"
#include "filters/model_file/form.h"

namespace ifog {

// Default averaging time of a mean square: short for the filter, long for vibration.
inline constexpr double kPowerAverage_s = 1.0;

struct ShapeSettings {
  Form form = Form::kLinear;
  double reference = 0.0;        // channel value at which the shape is zero
  double time_constant_s = 0.0;  // of rate, second_rate, lagged, band_power, warm_up; 0: no smoothing
  // lagged: second stage; band_power: averaging time, 0: one second.
  double second_time_constant_s = 0.0;
  // band_power: the low-pass starts as a running mean. Models without average_s were fitted to a low-pass
  // that starts at the first sample.
  bool begins_at_mean = false;
  std::vector<double> table_x, table_y;  // lookup
  double period = 0.0;                   // lookup (0: not periodic), cosine, sine
  double half_width = 0.0;               // dead_zone, transition; for a power above one its curve_reach
  bool angle = false;
  // cosine, sine of a channel that is no angle (fringe); extrapolated like a polynomial.
  bool fringe = false;
  double elapsed_s = 0.0;  // warm_up: time since power-up at the first sample
};

ShapeSettings shape_settings(
    const Effect& effect);  // of the effect's own channel; "product": the linear first factor
ShapeSettings with_shape_settings(const Effect& effect);  // "product": the second factor

class Shape {
 public:
  // Throws std::invalid_argument for a lookup without a table, a cosine or sine without a period, a
  // transition without a width, a negative time constant or half width, or a form without a channel other
  // than warm_up and rate_ramp.
  explicit Shape(ShapeSettings settings);

  // Processes one sample. The first sample initialises the low-pass, as if the channel had been constant
  // before; a rate_ramp is the time since it. No allocation, no exception.
  double step(double value, double dt_s) noexcept;
  // Processes several samples given by mean and variance, equivalently for quadratic and band_power.
  double step_over(double value, double scatter, double dt_s) noexcept;
  void restart() noexcept { started_ = false; }
  // Sets ShapeSettings::elapsed_s of a warm_up, before the first sample.
  void begin(double elapsed_s) noexcept { settings_.elapsed_s = elapsed_s; }

  // Processes one sample of a channel that may be outside the fitted range; see reach.h.
  double step(const Reach& channel, double dt_s) noexcept;

  // Value of a form without memory.
  [[nodiscard]] double at(double value) const noexcept;
  // The same with extrapolation.
  [[nodiscard]] double at(const Reach& channel) const noexcept;
  // Possible error outside the range, per unit of the coefficient: the part that is not extrapolated, for
  // higher powers also the difference of power and tangent, for a transition the rest of its change.
  [[nodiscard]] double left_behind(const Reach& channel) const noexcept;
  // The same for a curvature that the fit could not detect, per unit of the coefficient's standard error.
  // Over a range of width S, uniformly visited, the error of a linear term is s/(S sqrt(n/12)), of a
  // quadratic one, orthogonal to it, s/(S^2 sqrt(n/180)): larger by sqrt(15)/S. At x beyond the edge it has
  // grown by S x + x^2.
  [[nodiscard]] double unseen_curvature(const Reach& channel) const noexcept;

  [[nodiscard]] const ShapeSettings& settings() const noexcept { return settings_; }
  // Continues the state of another compensator's shape; false if the shape differs.
  bool take_over(const Shape& previous) noexcept;

 private:
  [[nodiscard]] double table(double value) const noexcept;
  [[nodiscard]] double slope(double value) const noexcept;
  [[nodiscard]] bool goes_on() const noexcept { return settings_.form != Form::kLookup; }

  // Members read by step(), adjacent.
  double first_ = 0.0, second_ = 0.0, elapsed_ = 0.0, dt_ = 0.0, alpha_ = 1.0, beta_ = 1.0;
  bool started_ = false;
  bool has_state_ = false;  // a step depends on the channel's past or on time
  bool bounded_ = false;
  int power_ = 0;  // power_of() the form
  ShapeSettings settings_;
};

}  // namespace ifog
