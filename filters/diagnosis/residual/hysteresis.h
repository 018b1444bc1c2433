// SPDX-License-Identifier: Apache-2.0
// A bias that depends on which way a channel came: the loop of the play operator, which no form of the model
// file describes. It is told apart all the same, since for as long as the channel moves one way it looks like
// the channel's rate, or like a polynomial of it, and fails as soon as the channel turns.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// What is left of the play operator (Prandtl and Ishlinskii; Krasnosel'skii and Pokrovskii, Systems with
// Hysteresis, 1989) when the channel itself is taken out: within half_width of zero, from block to block.
// It starts at zero, as nothing says where the channel came from.
Eigen::VectorXd hysteresis_loop(const BlockData& data, std::size_t channel, double half_width);

// Takes a loop of the channel out of the error of the grid's valid blocks.
void take_out(const Hysteresis& loop, const BlockData& data, BlockGrid& grid);

struct LoopFit {
  std::size_t channel = Candidate::kNone;
  Hysteresis loop;                    // ratio: against the model, below zero when it explains less
  NoiseFit noise;                     // with it
  std::vector<Candidate> beside;      // other channels' effects, and the channel's linear one
  std::vector<Candidate> instead_of;  // the channel's effects in the model, the linear one too
  double saved = 0.0;                 // parameters that the model has more than the loop
};

// Of every smooth channel the best loop, fitted in place of what the model says of that channel but for a
// linear effect. `noise`: fitted with the model. Empty on a rate table, where time is no order.
std::vector<LoopFit> fit_loops(const BlockData& data, const std::vector<Candidate>& model,
                               const NoiseFit& noise);

// The one that overrules the model. A width and a channel were chosen, so it has to be certain: ten times
// below `significance` after correction for that. Where the model claims more of the channel than a linear
// effect, something bends there, and the loop need only be the better by the Bayesian information criterion:
// as long as a channel does not turn, its rate or effects that cancel each other imitate it.
std::optional<Hysteresis> certain_hysteresis(const BlockData& data, const std::vector<LoopFit>& fits,
                                             double significance);

}  // namespace ifog
