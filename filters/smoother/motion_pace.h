// SPDX-License-Identifier: Apache-2.0
// How quickly the rate of a recording moves, sample by sample, where it is known to move at all.
//
// From the measurement itself on, each longer memory is compared with the one before it: both smooth the
// part, and the longer one is taken where the squares of what it leaves, over twelve memories about the
// sample, say that it is no further from the truth. Of a linear smoother the sum of (measured - smoothed)^2 +
// 2 P is the sum of its squared errors and a constant, on average (Mallows, "Some comments on Cp",
// Technometrics 15(4), 1973), P being its variance. It stops at the first that is not as good, so that what
// is spoiled by a corner far away is not asked (Lepski, Theory of Probability and its Applications 35(3),
// 1991). Four fifths of the memory that was found are used: what is left of a motion goes, squared, with the
// twelfth power of it, so that it is small beside the variance, as that says nothing of it.
#pragma once

#include <span>

#include "filters/smoother/motion_smoother.h"

namespace ifog {

// course: whose memories are not looked at. memories: of each sample that is not pace::kRest it is found, in
// runs of such. longest: that is tried, samples. Allocates.
void find_paces(const RateCourse& course, double noise, double longest, std::span<float> memories);

}  // namespace ifog
