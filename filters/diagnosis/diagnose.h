// SPDX-License-Identifier: Apache-2.0
// The diagnosis of one axis of one sensor: what in its error is explained by an effect, what that effect is,
// how large the error is before and after, what cannot be told apart, and what stays.
//
// Every test is made in the innovations of the noise model's own Kalman filter, so that slow noise is not
// taken for an effect of something slow; see search/search.h for the search and regression/whitening.h for
// the filter.
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
  double significance = 0.01;  // of a false effect, after correction for everything tried
  std::string axis;            // written into the effects found
  // The part of each record that is fitted, as fractions of its time; the rest judges. Equal: all of it is
  // fitted, and blocks of it take turns at being held out.
  double fit_from = 0.0, fit_to = 1.0;
  std::size_t most_effects = 8;
  bool subtract_earth_rate = false;    // what the Earth's rate explains; otherwise it is shown, no more
  std::optional<double> latitude_rad;  // bounds its size further
  // Without a reference rate a channel that senses motion explains nothing of the rate, unless this is set.
  bool allow_motion_channels = false;
  // A coefficient beyond what makers specify is shown as a proxy and not corrected, unless this is set.
  bool allow_proxies = false;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

// Throws std::invalid_argument, one line: no record, a part to fit that ends before it begins, spans of
// unequal length, a reference in some records only, fewer than 32 usable samples.
Diagnosis diagnose(const std::vector<Record>& records, const DiagnoseOptions& options);

}  // namespace ifog
