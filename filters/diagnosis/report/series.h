// SPDX-License-Identifier: Apache-2.0
// What a report draws of a diagnosis.
#pragma once

#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// parts: rad/s by block, of each chosen effect; effects: those and others after them; noise: what they leave,
// by which the deviation after is known.
DiagnosisSeries series_of(const BlockData& data, const std::vector<EvenError>& errors,
                          const std::vector<Chosen>& chosen, const std::vector<FoundEffect>& effects,
                          const std::vector<Eigen::VectorXd>& parts, const NoiseTerms& noise);

}  // namespace ifog
