// SPDX-License-Identifier: Apache-2.0
// Innovations of a sensor's axes in words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "msgs/axis_name.h"

namespace ifog::tools {

// "x NIS 0.97, whiteness +0.01; y no value", of status_t's nis_mean and whiteness or means of them: a mean
// square of exactly nothing is that of an axis that has had no value.
inline std::string axis_health(const std::vector<double>& nis, const std::vector<double>& whiteness) {
  std::string out;
  for (std::size_t a = 0; a < nis.size(); ++a) {
    std::array<char, 60> figures{"no value"};
    if (nis[a] != 0.0)
      std::snprintf(figures.data(), figures.size(), "NIS %.3f, whiteness %+.3f", nis[a], whiteness[a]);
    out += a == 0 ? "" : "; ";
    out += axis_name(a, nis.size());
    out += ' ';
    out += figures.data();
  }
  return out;
}

}  // namespace ifog::tools
