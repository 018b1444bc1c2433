// SPDX-License-Identifier: Apache-2.0
// Whether an effect is the same all along the record. What no form covers can look like a form for a while,
// and then another coefficient fits every part of the record.
#pragma once

#include <vector>

#include "filters/diagnosis/regression/design.h"

namespace ifog {

struct Unsteadiness {
  double square = 0.0;  // chi-square of three degrees of freedom where the coefficients are the same
  double share = 0.0;   // of the effect's own chi-square, what goes into their differences
};

// Chow's test (Econometrica 28, 1960) in innovations, with White's errors (Econometrica 48, 1980), so that
// noise which changes along the record does not count: how far the coefficients of effect `at` in four
// contiguous parts, which hold the same energy of its regressor, lie from one for all. Of a strong effect,
// whose form is never quite that of nature, the share says whether it matters.
Unsteadiness unsteadiness(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                          const NoiseShape& shape);

}  // namespace ifog
