// SPDX-License-Identifier: Apache-2.0
// What a model leaves of the heading of a capture not yet made: exact for the linear functional "angle after
// alignment", from the state space that the diagnosis fitted and the regressors of the capture's own
// channels.
#pragma once

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// bias taken over aligned_s, angle integrated from then to each of after_s. Of `next` only times and channels
// count, and the reference when effects use one. Effects without a channel in it count as not corrected
// and not there.
HeadingPrediction predict_heading(const Diagnosis& diagnosis, const Record& next, double aligned_s,
                                  const std::vector<double>& after_s);

// Heading error of a next capture whose channels run as they did in the longest record.
HeadingPrediction predict_like_longest(const Diagnosis& diagnosis, const std::vector<Record>& records);

// Variance of the heading error by noise alone, without the motion of what the sensor stands on, rad^2.
double heading_variance(const NoisePosterior& posterior, double aligned_s, double after_s);

}  // namespace ifog
