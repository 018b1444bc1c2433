// SPDX-License-Identifier: Apache-2.0
// Optimises the parameters that the search takes from a grid: time constants and transitions.
#pragma once

#include <cstddef>

#include "filters/diagnosis/regression/design.h"

namespace ifog {

// Sets the time constant of model[at] to its most likely value within a factor of 2.5 (roughly within
// time_constants()), with free coefficients and fixed noise. which: first or second time constant.
void refine(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model, std::size_t at,
            double Candidate::*which = &Candidate::time_constant_s);

// Optimises all searched parameters of model[at]: time constant, or centre and width of a transition. A
// centre keeps its distance from the edges of the channel's range. Both levels
// of a transition are visible: the range extends one half width to either side; otherwise a polynomial describes the
// bend.
void refine_shape(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model,
                  std::size_t at);

// Adds a second time constant to each effect whose gain exceeds its cost. A coil in a housing follows the
// thermometer with two time constants; the effect of vibration power has two as well.
void try_second_time_constants(const BlockData& data, FittedModel& model);

}  // namespace ifog
