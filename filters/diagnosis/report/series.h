// SPDX-License-Identifier: Apache-2.0
// Data of a diagnosis for the report's pictures.
#pragma once

#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// parts: rad/s by block, of each chosen effect; effects: the chosen ones, then others; noise: of the
// residual, for the confidence of the deviation after.
DiagnosisSeries series_of(const BlockData& data, const std::vector<EvenError>& errors,
                          const std::vector<Chosen>& chosen, const std::vector<FoundEffect>& effects,
                          const std::vector<Eigen::VectorXd>& parts, const NoiseTerms& noise);

}  // namespace ifog
