// SPDX-License-Identifier: Apache-2.0
// A chart's data for the page's script, see page.js.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace ifog::report {

// The same curve in fewer points with its extremes; short curves are unchanged.
struct Thinned {
  std::vector<double> x, y;
};
Thinned thinned(std::span<const double> x, std::span<const double> y);

// As float32, little-endian, base64: its seven digits exceed the screen's resolution.
std::string packed(std::span<const double> values);

// Inserts a NaN in the middle of each gap: a step of more than ten times the usual one. y has the length of
// time.
void open_at_holes(std::vector<double>& time, std::vector<double>& y);

}  // namespace ifog::report
