// SPDX-License-Identifier: Apache-2.0
// Innovation statistics of a sensor's axes as text.
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <string>
#include <vector>

#include "msgs/axis_name.h"

namespace ifog::tools {

// "x NIS 0.97, whiteness +0.01; y no value", from nis_mean and whiteness in status_t, or means of them. A
// mean square of exactly 0 means that the axis had no value.
inline std::string axis_health(const std::vector<double>& nis, const std::vector<double>& whiteness) {
  std::string out;
  for (std::size_t a = 0; a < nis.size(); ++a) {
    out += a == 0 ? "" : "; ";
    out += axis_name(a, nis.size());
    out += nis[a] == 0.0 ? " no value" : fmt::format(" NIS {:.3f}, whiteness {:+.3f}", nis[a], whiteness[a]);
  }
  return out;
}

}  // namespace ifog::tools
