// SPDX-License-Identifier: Apache-2.0
// Validation of effects on data that they were not fitted to: held-out blocks, the blocks behind a step, other captures.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Cross-validation: effects with coefficients of all blocks, and with coefficients fitted without the block's
// own part of the record. A rate table has ten contiguous parts; a time series four, interleaved, so that all cover
// slow channels.

// By block, the change of the corrected effects if coefficients of the other folds are used. Relative to the
// mean of each record, as otherwise a channel far from zero would step between folds. coefficients: of all
// blocks.
Eigen::VectorXd held_out_change(const BlockData& data, const std::vector<Candidate>& effects,
                                const NoiseShape& shape, const Eigen::VectorXd& coefficients);

// True if the last effect's coefficients from the other folds reduce the innovations over all folds.
// Constants and earlier effects are projected out on all blocks first.
bool predicts_held_out(const BlockData& data, const FittedModel& model);

// True if the last effect, a step, lasts: the means before and after it differ by it. A shock looks like a
// step in the innovations, and a temporary change like two.
bool step_persists(const BlockData& data, const FittedModel& model);

// Predicts each capture of one sensor from the others. If a channel was correlated with the true cause only
// in one capture, its correction makes another capture worse.

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
