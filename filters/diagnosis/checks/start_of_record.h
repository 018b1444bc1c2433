// SPDX-License-Identifier: Apache-2.0
// What settles at the start of a record, and a filter that does not know how the record began.
#pragma once

#include "filters/diagnosis/regression/design.h"

namespace ifog {

// Twice the log-likelihood that effect `at` gains in the innovations, beside the others and beside the states
// of the noise at the start of each record, which the steady filter takes for known (see
// Whitening::doubt_at_start): a swaying structure's phase or flicker that happened to be high settle just as
// a warm-up does.
double ratio_beside_the_start(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                              const NoiseShape& shape);

}  // namespace ifog
