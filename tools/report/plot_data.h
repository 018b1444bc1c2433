// SPDX-License-Identifier: Apache-2.0
// Numbers of a chart for the script of a page, see page.js.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace ifog::report {

// The same curve in fewer points, its extremes kept; one that is short enough as it is.
struct Thinned {
  std::vector<double> x, y;
};
Thinned thinned(std::span<const double> x, std::span<const double> y);

// As float32, little-endian, in base64: seven digits are more than a screen shows.
std::string packed(std::span<const double> values);

// A point that is no number in the middle of each hole: where the time advances by more than ten of its
// steps. As many y as times.
void open_at_holes(std::vector<double>& time, std::vector<double>& y);

}  // namespace ifog::report
