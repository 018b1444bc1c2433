// SPDX-License-Identifier: Apache-2.0
// Whether a change of a sensor's correction keeps what was promised of it, on data that it was not fitted on.
//
// The old model's error e holds what the new one corrects, d (old corrected rate less new corrected rate),
// some number of times: e = bias + share * d + noise. As promised the share is 1; where the new model
// corrects what is not there it is 0. Up to 0.5 the new model leaves no less than the old one.
//
// The noise is slow as well as white, so share is estimated in the innovations of a local level: both series
// through one Kalman filter with a diffuse start, which takes the bias out (generalised least squares; A. C.
// Harvey, "Forecasting, Structural Time Series Models and the Kalman Filter", 1989, section 3.4). The ratio
// of walk to noise is that of greatest likelihood without d. The error of the share is not that of
// white innovations, which real ones are not, but from the scatter of its parts between chapters of the data
// (the sandwich of H. White, Econometrica 48, 1980).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

// All as long as time_s; NaN: missing.
struct CorrectionTrial {
  std::span<const double> time_s;        // increasing, s
  std::span<const double> before_radps;  // corrected by the old model
  std::span<const double> after_radps;   // by the new one
  std::span<const Stretch> at_rest;      // samples that count, in order
};

// Root mean square of means over averaging_s, about the mean of them all.
struct ErrorOfMeans {
  double averaging_s = 0.0;
  std::size_t means = 0;
  double before_radps = 0.0, after_radps = 0.0;
};

struct PromiseKept {
  double seconds = 0.0;                   // of data
  double share = 0.0, share_error = 0.0;  // share_error infinite: d does not move here
  double walk_ratio = 0.0;                // of the level's growth in a sample to the noise, variances
  std::vector<ErrorOfMeans> errors;       // of 1, 10 and 100 s where there are eight such means
};

enum class PromiseVerdict {
  kept,     // share is surely more than 0.5, and 1 is possible or nearer than 0.1
  in_part,  // surely more than 0.5, and surely not 1
  broken,   // surely less than 0.5: the old model was better
  open,     // the data do not tell
};

// Throws std::invalid_argument: series of unequal length, fewer than 100 samples at rest.
[[nodiscard]] PromiseKept weigh_promise(const CorrectionTrial& trial);

// Surely: three standard errors.
[[nodiscard]] PromiseVerdict verdict(const PromiseKept& kept);

}  // namespace ifog
