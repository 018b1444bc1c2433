// SPDX-License-Identifier: Apache-2.0
// Predicts each capture of one sensor from the others. If a channel was correlated with the true cause only
// in one capture, its correction makes another capture worse.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Effects that share a channel, because two of them may describe one law.
struct DeniedEffects {
  std::vector<std::size_t> effects;  // ascending
  std::size_t record = 0;            // record that refutes them
  // Share of the prediction from the other captures that is present in this one; below 0.5 a correction
  // increases the error. NaN: the others predict nothing certain, but the regressors vary as much here and
  // the effects are absent.
  double share = 0.0, share_error = 0.0;
};

// Effects whose share is below 0.5 by four standard errors, or that are absent here although the regressors
// vary. nullopt with one record. data: reconstructed.
std::optional<DeniedEffects> denied_by_a_capture(const BlockData& data, const std::vector<Candidate>& effects,
                                                 const NoiseFit& noise);

}  // namespace ifog
