// SPDX-License-Identifier: Apache-2.0
// Whether an effect lives on a few blocks. Knocks and jumps are no Gaussian noise: a few huge innovations let
// any channel that moves at the right moments gain more likelihood than chance in Gaussian noise would.
#pragma once

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Twice the log-likelihood lost without effect `at` of the model, blocks left out whose innovation is more
// than four standard deviations (from the median of their sizes) from zero. In Gaussian noise that is one
// block in 16 000, and the ratio is the ordinary one at this noise.
double ratio_without_outliers(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                              const NoiseShape& shape);

// The square of effect `at`'s coefficient over its variance as the innovations themselves show it, block by
// block and with those that follow each other (White 1980; Newey and West 1987): noise that comes and goes
// counts where it is. Equals the ordinary ratio in noise that is the same all along.
double ratio_in_changing_noise(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                               const NoiseShape& shape);

}  // namespace ifog
