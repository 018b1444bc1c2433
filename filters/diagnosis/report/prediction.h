// SPDX-License-Identifier: Apache-2.0
// Expected heading error of a future capture with a model: exact for the linear functional "angle after
// alignment", from the fitted state space and the regressors of the capture's channels.
#pragma once

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// Bias: mean over aligned_s; the angle is integrated from there to each of after_s. next: its times and
// channels are used, and its reference if effects need it; the channels are taken to be within the fitted ranges.
// An effect without a channel there counts as absent.
HeadingPrediction predict_heading(const Diagnosis& diagnosis, const Record& next, double aligned_s,
                                  const std::vector<double>& after_s);

// Heading error of a capture whose channels behave as in the longest record.
HeadingPrediction predict_like_longest(const Diagnosis& diagnosis, const std::vector<Record>& records);

// Variance of the heading error by noise alone, rad^2, without motion of the sensor's support.
double heading_variance(const NoisePosterior& posterior, double aligned_s, double after_s);

// Variance by noise of the mean over records of these durations, whose walks start at zero, (rad/s)^2.
double mean_variance(const NoisePosterior& posterior, const std::vector<double>& spans_s);

}  // namespace ifog
