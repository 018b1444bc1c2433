// SPDX-License-Identifier: Apache-2.0
// A bias that depends on which way a channel came: the loop of the play operator, which no form of the model
// file describes. It is recognised all the same, since for as long as the channel moves one way it looks like
// the channel's rate, or like a polynomial of it, and fails as soon as the channel turns.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// What is left of the play operator (Prandtl and Ishlinskii; Krasnosel'skii and Pokrovskii, Systems with
// Hysteresis, 1989) when the channel itself is removed: within half_width of zero, from block to block.
// It starts at zero, as nothing says where the channel came from.
Eigen::VectorXd hysteresis_loop(const BlockData& data, std::size_t channel, double half_width);

// Takes a loop of the channel out of the error of the grid's valid blocks.
void take_out(const Hysteresis& loop, const BlockData& data, BlockGrid& grid);

// The loop of a smooth channel that overrules what the model says of that channel but for a linear effect, by
// more than chance and the widths tried; or, where the model claims more than that, by the Bayesian
// information criterion. None on a rate table, where time is no order.
std::optional<Hysteresis> find_hysteresis(const BlockData& data, const std::vector<Candidate>& model,
                                          const NoiseFit& noise, double significance);

}  // namespace ifog
