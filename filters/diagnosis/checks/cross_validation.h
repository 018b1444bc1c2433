// SPDX-License-Identifier: Apache-2.0
// Cross-validation: effects by coefficients of all blocks, and by those that were fitted without the block's
// own part of the record.
#pragma once

#include <vector>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Coefficients of the effects' columns for each part that is held out in turn, from the blocks of the others.
// Zero for what happened in the held-out part alone. Of a rate table ten contiguous parts; of a time series
// four, of pieces in turn, so that slow channels are seen by all.
std::vector<Eigen::VectorXd> coefficients_without_each_fold(const BlockGrid& grid, const NoiseShape& shape,
                                                            const Columns& columns);

// By block, what the effects that are corrected take more with the coefficients of the other folds than with
// those of all blocks; about the mean of each record, for without that a channel far from zero would step
// from fold to fold. coefficients: of all blocks, the constants first.
Eigen::VectorXd held_out_change(const BlockData& data, const std::vector<Candidate>& effects,
                                const NoiseShape& shape, const Eigen::VectorXd& coefficients);

// What an effect has to prove beyond its likelihood.
// A model whose last effect is on trial, with the noise that belongs to it.
struct Claimed {
  const std::vector<Candidate>& model;
  const NoiseFit& noise;
};

// Whether the last effect's coefficient from the other folds makes the innovations of each fold smaller, all
// folds together. Constants and the effects before it are projected out on all blocks first.
bool predicts_held_out(const BlockData& data, const Claimed& claimed);

// A knock makes innovations like a step's, and what goes away and comes back those of two. A step is still
// there later: the means before and after differ by it, whatever other steps there are.
bool step_persists(const BlockData& data, const Claimed& claimed);

}  // namespace ifog
