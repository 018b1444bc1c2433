// SPDX-License-Identifier: Apache-2.0
// Test on other data whether a change of a sensor's correction achieves what was predicted.
//
// The old model's error is e = bias + share * d + noise, where d is the old minus the new corrected rate. The
// share is 1 if the change works as predicted and 0 if it corrects something that is not there; below 0.5 the
// new model is worse than the old one.
//
// The noise has a slow part, so the share is estimated in the innovations of a local level model with diffuse
// start, which removes the bias (generalised least squares; A. C. Harvey, "Forecasting, Structural Time
// Series Models and the Kalman Filter", 1989, section 3.4). The ratio of walk to noise maximises the
// likelihood without d. The standard error is from the scatter between chapters of the data (sandwich
// estimator, H. White, Econometrica 48, 1980), because real innovations are not white.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

// All as long as time_s; NaN if missing.
struct CorrectionTrial {
  std::span<const double> time_s;        // increasing, s
  std::span<const double> before_radps;  // corrected by the old model
  std::span<const double> after_radps;   // corrected by the new model
  std::span<const Stretch> at_rest;      // samples to be used, in order
};

// RMS of means over averaging_s, about their common mean.
struct ErrorOfMeans {
  double averaging_s = 0.0;
  std::size_t means = 0;
  double before_radps = 0.0, after_radps = 0.0;
};

struct PromiseKept {
  double seconds = 0.0;                   // duration of the data
  double share = 0.0, share_error = 0.0;  // share_error is infinite if d does not vary
  double walk_ratio = 0.0;                // variance of the level's step per sample / noise variance
  std::vector<ErrorOfMeans> errors;       // for 1, 10 and 100 s if there are eight means
};

enum class PromiseVerdict {
  kept,     // share is certainly above 0.5, and 1 is possible or within 0.1
  in_part,  // certainly above 0.5 and not 1
  broken,   // certainly below 0.5: the old model was better
  open,     // undecided
};

// Throws std::invalid_argument: series of unequal length, fewer than 100 samples at rest.
[[nodiscard]] PromiseKept weigh_promise(const CorrectionTrial& trial);

// Certainly: by three standard errors.
[[nodiscard]] PromiseVerdict verdict(const PromiseKept& kept);

}  // namespace ifog
