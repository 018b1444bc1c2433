// SPDX-License-Identifier: Apache-2.0
// What the effects of block means leave: dead zone, hysteresis, and words on the rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/residual/lines.h"

namespace ifog {

// Dead zone: a rate below which the sensor outputs only its bias, so the error is minus the rotation. A turn
// crosses it in a few samples. So it is detected in samples, relative to a mean over some seconds, before the
// effects of block means.

// Subtracts the zone's error from the residuals `rest` and from the grid's block means. nullopt, and nothing is
// subtracted, if chance or a single crossing explains it, or if the coefficient, of the crossings too, is not -1 (a scale
// factor, noise of the reference). records: with a reference; its channel is the effect's.
std::optional<FoundEffect> take_out_dead_zone(const std::vector<Record>& records, const std::string& channel,
                                              double significance, BlockGrid& grid,
                                              std::vector<EvenError>& errors);

// Hysteresis: a bias that depends on the direction of a channel's change (play operator). The model file has
// no form for it. It must be detected because, while the channel moves one way, it looks like an effect of
// the channel's rate or a polynomial; this fails when the channel turns.

// Play operator minus the channel itself (Prandtl and Ishlinskii; Krasnosel'skii and Pokrovskii, Systems with
// Hysteresis, 1989): within ± half_width, by block. Starts at zero because the history is unknown.
Eigen::VectorXd hysteresis_loop(const BlockData& data, std::size_t channel, double half_width);

// Subtracts a channel's loop from the error of the grid's valid blocks.
void take_out(const Hysteresis& loop, const BlockData& data, BlockGrid& grid);

// Loop of a smooth channel that, in place of the model's effects of that channel, explains so much more of the error
// that chance does not reach it with the number of widths. nullopt on a rate table, which has no time order.
std::optional<Hysteresis> find_hysteresis(const BlockData& data, const std::vector<Candidate>& model,
                                          const NoiseFit& noise, double significance);

// Describes the residual in words on which a person can act.

// Describes the longest record's residual, in which peaks are searched (not on a rate table). of_samples: effects
// that were taken out of the samples.
Unexplained describe_rest(const std::vector<Record>& records, const std::vector<EvenError>& errors,
                          const std::vector<FoundEffect>& of_samples, const NoiseFit& noise,
                          const BlockGrid& grid, double significance,
                          const std::vector<NoiseChangeIn>& noise_changes);

// Replaces the description by that of the hysteresis.
void describe_hysteresis(const Hysteresis& loop, Unexplained& found);

}  // namespace ifog
