// SPDX-License-Identifier: Apache-2.0
// Cross-validation: effects with coefficients of all blocks, and with coefficients fitted without the block's
// own part of the record.
#pragma once

#include <vector>

#include "filters/diagnosis/regression/design.h"

namespace ifog {

// Coefficients of the effects' columns for each held-out part, fitted on the other parts. Zero for an effect
// that happened only in the held-out part. A rate table has ten contiguous parts; a time series four,
// interleaved, so that all cover slow channels.
std::vector<Eigen::VectorXd> coefficients_without_each_fold(const BlockGrid& grid, const NoiseShape& shape,
                                                            const Columns& columns);

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

}  // namespace ifog
