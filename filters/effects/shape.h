// One form applied to one channel, as causal code: the value per unit of the effect's coefficient, sample by
// sample. The regressors of the diagnosis and the corrections of the daemon both come from here, so that what
// was fitted is what is subtracted.
#pragma once

#include <vector>

#include "filters/effects/form.h"

namespace ifog {

struct ShapeSettings {
  Form form = Form::kLinear;
  double reference = 0.0;                // the channel's value at which the shape is zero
  double time_constant_s = 0.0;          // rate, second_rate, lagged, band_power, warm_up; 0: no smoothing
  double second_time_constant_s = 0.0;   // lagged: a second stage
  std::vector<double> table_x, table_y;  // lookup
  double period = 0.0;
  bool angle = false;
};

ShapeSettings shape_settings(
    const Effect& effect);  // of the effect's own channel; "product": its linear first factor
ShapeSettings with_shape_settings(const Effect& effect);  // "product": the second factor

class Shape {
 public:
  // Throws std::invalid_argument for a lookup without a table, a negative time constant or a form without a
  // channel other than warm_up.
  explicit Shape(ShapeSettings settings);

  // One sample: the channel's value, and the time it covers. The first sample sets the low-pass to itself, as
  // if the channel had always been there. No allocation, no exception.
  double step(double value, double dt_s) noexcept;
  void restart() noexcept { started_ = false; }

  // Of a form without memory: its value at one value of the channel.
  [[nodiscard]] double at(double value) const noexcept;
  // How much the shape moves when the channel moves by `excess` beyond `value`, to first order.
  [[nodiscard]] double moves_by(double value, double excess) const noexcept;

  [[nodiscard]] const ShapeSettings& settings() const noexcept { return settings_; }
  // The same shape of another compensator goes on where that one is. False when it is not the same shape.
  bool take_over(const Shape& previous) noexcept;

 private:
  [[nodiscard]] double table(double value) const noexcept;

  ShapeSettings settings_;
  double first_ = 0.0, second_ = 0.0, elapsed_ = 0.0, dt_ = 0.0, alpha_ = 1.0, beta_ = 1.0;
  bool started_ = false;
};

}  // namespace ifog
