// SPDX-License-Identifier: Apache-2.0
// Selects the smoothing memory for each sample of a recording in motion.
//
// Starting with the measurement itself, each longer memory is compared with the one before over twelve
// memories about the sample. The longer one is accepted if its estimated risk is not higher: for a linear
// smoother of variance P the sum of (measured - smoothed)^2 + 2 P is on average its sum of squared errors
// plus a constant (Mallows, Technometrics 15(4), 1973). The search stops at the first rejection, so a distant
// corner has no influence (Lepski, Theory of Probability and its Applications 35(3), 1991). Four fifths of
// the memory found are used: the squared motion error falls with its twelfth power and becomes small against
// the variance, which does not include it.
#pragma once

#include <span>

#include "filters/smoother/motion_smoother.h"

namespace ifog {

// Sets the memory of each sample that is not pace::kRest; runs of such samples are treated separately.
// course: its memories are ignored. longest: largest memory tried, samples. Allocates.
void find_paces(const RateCourse& course, double noise, double longest, std::span<float> memories);

}  // namespace ifog
