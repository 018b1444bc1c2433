// SPDX-License-Identifier: Apache-2.0
// Hysteresis: a bias that depends on the direction of a channel's change (play operator). The model file has
// no form for it. It must be detected because, while the channel moves one way, it looks like an effect of
// the channel's rate or a polynomial; this fails when the channel turns.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Play operator minus the channel itself (Prandtl and Ishlinskii; Krasnosel'skii and Pokrovskii, Systems with
// Hysteresis, 1989): within ± half_width, by block. Starts at zero because the history is unknown.
Eigen::VectorXd hysteresis_loop(const BlockData& data, std::size_t channel, double half_width);

// Subtracts a channel's loop from the error of the grid's valid blocks.
void take_out(const Hysteresis& loop, const BlockData& data, BlockGrid& grid);

// Loop of a smooth channel that, in place of the model's effects of that channel, explains so much more of the error
// that chance does not reach it with the number of widths. nullopt on a rate table, which has no time order.
std::optional<Hysteresis> find_hysteresis(const BlockData& data, const std::vector<Candidate>& model,
                                          const NoiseFit& noise, double significance);

}  // namespace ifog
