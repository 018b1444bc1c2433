// SPDX-License-Identifier: Apache-2.0
#include "tools/report/time_axis.h"

#include <algorithm>
#include <cmath>

namespace ifog::report {

TimeAxis::TimeAxis(double first_s, double last_s)
    : first_s_(first_s), last_s_(last_s), unit_(time_unit(last_s - first_s)) {
  constexpr double kLong = 1e5, kFar = 10.0;  // kLong in s; kFar in lengths of the picture
  const double far = std::max(std::abs(first_s), std::abs(last_s));
  if (far >= kLong && far > kFar * (last_s - first_s)) origin_s_ = std::floor(first_s);
}

std::vector<double> TimeAxis::operator()(std::vector<double> time_s) const {
  for (double& time : time_s) time = (*this)(time);
  return time_s;
}

std::string TimeAxis::label() const {
  const std::string since = origin_s_ == 0.0 ? "" : " since " + at_power(origin_s_, 0, 0) + " s";
  return "time" + since + " (" + unit_.name + ")";
}

ChartAxis TimeAxis::axis(bool numbered) const {
  return {numbered ? label() : "", false, (*this)(first_s_), (*this)(last_s_), numbered};
}

}  // namespace ifog::report
