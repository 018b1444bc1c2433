// SPDX-License-Identifier: Apache-2.0
// Improves a gyro's model with the population: adds the type's effects that are too weak for its own
// captures, and shrinks all coefficients towards the population.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/population/population.h"
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

// The gyro's model with the type's effects that it has, and without those it does not have. Coefficients that
// were fitted with them are conditional on the type's distribution; lines, tables and other parts are
// unchanged. Sets with_prior of `effects` for this gyro.
Model model_with_prior(const Model& own, const TypeToMeasure& type, const GyroMeasured& measured,
                       std::size_t gyro, std::vector<TypeEffect>& effects);

}  // namespace ifog::tools
