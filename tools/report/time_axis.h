// SPDX-License-Identifier: Apache-2.0
// Times on a picture's axis: in a suitable unit, and relative to a whole second if the record's times are too
// long to read (seconds since 1970 or 1980).
#pragma once

#include <string>
#include <vector>

#include "tools/report/scale.h"
#include "tools/report/text.h"

namespace ifog::report {

class TimeAxis {
 public:
  // Limits of the picture.
  TimeAxis(double first_s, double last_s);

  // Value on the axis for a time in s.
  [[nodiscard]] double operator()(double time_s) const { return (time_s - origin_s_) / unit_.seconds; }
  [[nodiscard]] std::vector<double> operator()(std::vector<double> time_s) const;
  // "time (min)", "time since 1700000000 s (min)".
  [[nodiscard]] std::string label() const;
  // From the first to the last time; without label and numbers if the picture below has them.
  [[nodiscard]] ChartAxis axis(bool numbered = true) const;

 private:
  double first_s_, last_s_;
  TimeUnit unit_;
  double origin_s_ = 0.0;
};

}  // namespace ifog::report
