// SPDX-License-Identifier: Apache-2.0
// Tables of the scores of many sensors by kind and size, with their targets.
#pragma once

#include <ostream>
#include <vector>

#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

struct Totals {
  int sensors = 0, right = 0, exact = 0, missed = 0, extra = 0,
      completed = 0;  // sensors, not effects; without uncovered ones
  int effect_free = 0, false_alarms = 0;
  int uncovered = 0, uncovered_said = 0, made_worse = 0;
  double error_median = 0.0, error_p90 = 0.0;              // of transferable effects rightly found or missed
  double shape_error_median = 0.0, shape_error_p90 = 0.0;  // the same without the mean
  double coverage = 0.0;                                   // of 95 % intervals
  int intervals = 0;
  double interval_width = 0.0;  // median, coefficients' standard errors relative to the oracle's
  // Means over all, over effect-free sensors, over those diagnosed right; fraction within 1.96 sigma.
  double heading_square = 0.0, heading_square_free = 0.0, heading_square_right = 0.0, heading_within = 0.0;
  int headings = 0, headings_free = 0, headings_wrong = 0;
  int contradictory = 0;  // reports, of all sensors
  double seconds_each = 0.0;
};

Totals total(const std::vector<Score>& scores);

// Prints tables by kind, by size if sizes differ, coverage of the parameters by name, and totals with
// targets.
void print(std::ostream& out, const std::vector<Score>& scores);

// Prints one line per wrong sensor, sufficient to reproduce it.
void print_failures(std::ostream& out, const std::vector<Score>& scores);

// Prints every interval (error / standard error) and heading error (found / predicted) by sensor.
void print_promises(std::ostream& out, const std::vector<Score>& scores);

}  // namespace ifog::undeclared
