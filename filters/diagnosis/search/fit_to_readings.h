// SPDX-License-Identifier: Apache-2.0
// The search fits an effect to what a channel was; the daemon has only what its sensor reads. A derivative of
// coarse readings with the effect's own bandwidth would be spikes, so the bandwidth, and the size with it,
// become those whose correction comes closest to the effect that was found.
#pragma once

#include "filters/diagnosis/search/search.h"

namespace ifog {

// Changes time constants, coefficients and covariance of what `result` chose where it matters, and leaves
// everything else. recorded: the readings; reconstructed: the reconstructed channels of the fit.
void fit_to_readings(const BlockData& recorded, const BlockData& reconstructed, SearchResult& result);

}  // namespace ifog
