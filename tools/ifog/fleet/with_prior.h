// SPDX-License-Identifier: Apache-2.0
// What the type gives back to each of its gyros: its effects where they are too weak for one gyro's captures
// alone, and all coefficients as well as the population knows them.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/population/population.h"
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

// The gyro's model with the type's effects that it was found to have and without those it was not, every
// coefficient that was fitted with them conditional on what the type says; lines, tables and whatever else
// was not in that fit as its own diagnosis left it. Fills in with_prior of `effects` for this gyro.
Model model_with_prior(const Model& own, const TypeToMeasure& type, const GyroMeasured& measured,
                       std::size_t gyro, std::vector<TypeEffect>& effects);

}  // namespace ifog::tools
