// SPDX-License-Identifier: Apache-2.0
// Searched time constants, and where a transition is, at their optimum.
#pragma once

#include <cstddef>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// The time constant of model[at] of greatest likelihood within a factor of 2.5, all coefficients free, the
// noise held; never outside what time_constants() spans by much. `which` is the first or the second one.
void refine(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model, std::size_t at,
            double Candidate::*which = &Candidate::time_constant_s);

// Whatever of model[at] is searched: its time constant, a transition's middle and width, or a fringe's period,
// of both halves. The middle stays off the edges of the channel's range and the width below a half of it.
void refine_shape(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model,
                  std::size_t at);

// Whether both levels of every transition lie within the channel's range, as far as one half width from its
// middle. What only bends there is a polynomial's to describe, which goes on where a level would stop.
bool levels_seen(const BlockData& data, const std::vector<Candidate>& model);

// What one effect stands for that is more: a second time constant, a second layer that heat passes, or a
// direction in the place of a product. Tried when the choice of one is made; each has to earn what it costs.
struct FittedModel {
  std::vector<Candidate> effects;
  NoiseFit noise;  // with them
};

// A coil inside a housing follows the thermometer through two time constants, and a bias follows the power of
// vibration as fast as it may.
void try_second_time_constants(const BlockData& data, FittedModel& model);

}  // namespace ifog
