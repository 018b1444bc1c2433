// SPDX-License-Identifier: Apache-2.0
// How times stand at a picture's axis: in the unit that the stretch is best read in, and counted from a whole
// second where the record's own would be numbers too long to read (seconds since 1970 or 1980).
#pragma once

#include <string>
#include <vector>

#include "tools/report/scale.h"
#include "tools/report/text.h"

namespace ifog::report {

class TimeAxis {
 public:
  // For a picture from the one time to the other.
  TimeAxis(double first_s, double last_s);

  // At the axis, of a time in s.
  [[nodiscard]] double operator()(double time_s) const { return (time_s - origin_s_) / unit_.seconds; }
  [[nodiscard]] std::vector<double> operator()(std::vector<double> time_s) const;
  // "time (min)", "time since 1700000000 s (min)".
  [[nodiscard]] std::string label() const;
  // From the first time to the last; without label and numbers where a picture below has them.
  [[nodiscard]] ChartAxis axis(bool numbered = true) const;

 private:
  double first_s_, last_s_;
  TimeUnit unit_;
  double origin_s_ = 0.0;
};

}  // namespace ifog::report
