// SPDX-License-Identifier: Apache-2.0
// What one effect stands for that is more: a second time constant, a second layer that heat passes, or a
// direction in the place of a product. Tried when the choice of one is made; each has to earn what it costs.
#pragma once

#include <cstddef>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

struct FittedModel {
  std::vector<Candidate> effects;
  NoiseFit noise;  // with them
};

// A coil inside a housing follows the thermometer through two time constants, and a bias follows the power of
// vibration as fast as it may. Effects from `first` on.
void try_second_time_constants(const BlockData& data, std::size_t first, FittedModel& model);

}  // namespace ifog
