// SPDX-License-Identifier: Apache-2.0
// What a report draws of a diagnosis.
#pragma once

#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/known_angles.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// parts: rad/s by block, of each chosen effect; effects: those and others after them.
DiagnosisSeries series_of(const BlockData& data, const std::vector<EvenError>& errors,
                          const std::vector<Chosen>& chosen, const std::vector<FoundEffect>& effects,
                          const std::vector<Eigen::VectorXd>& parts, KnownAngles& angles);

// How well the deviation after is known, under the noise that was found after it.
void add_allan_band(const EvenError& error, double sample_s, const NoiseTerms& noise, KnownAngles& angles,
                    DiagnosisSeries& series);

}  // namespace ifog
