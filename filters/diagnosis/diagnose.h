// SPDX-License-Identifier: Apache-2.0
// Diagnosis of one axis of one sensor: effects that explain its error, the error before and after, effects
// that cannot be distinguished, and what stays unexplained.
//
// All tests use the innovations of the noise model's Kalman filter, so that slow noise is not mistaken for an
// effect of a slow channel. See search/search.h for the search and regression/whitening.h for the filter.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"

namespace ifog {

struct DiagnoseOptions {
  double significance = 0.01;  // probability of a false effect, corrected for the number of tries
  std::string axis;            // written into the effects found
  // Part of each record that is fitted, as fractions of its time; the rest is for validation. If that is all
  // of it, validation is by cross-validation.
  double fit_from = 0.0, fit_to = 1.0;
  std::size_t most_effects = 8;
  bool subtract_earth_rate = false;  // subtract the effect of the Earth's rate; otherwise it is only reported
  std::optional<double> latitude_rad;  // limits the size of the Earth's rate
  // Without a reference, channels that sense motion explain nothing unless this is set.
  bool allow_motion_channels = false;
  // Coefficients beyond makers' specifications are reported as proxies and not corrected unless this is set.
  bool allow_proxies = false;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

// Throws std::invalid_argument with one line: no record, a fitted part that ends before it begins, spans of
// unequal length, a reference in some records only or of another sign or unit, fewer than 32 usable samples.
Diagnosis diagnose(const std::vector<Record>& records, const DiagnoseOptions& options);

}  // namespace ifog
