// SPDX-License-Identifier: Apache-2.0
// Coefficients compared with what makers specify. A channel that drifts with a thermometer that was not logged, or
// with the sensor's own ageing, explains the bias with a coefficient that no gyro has; on the next capture,
// where it moves by itself, the correction by it is many times the error.
#pragma once

#include <string>

#include "filters/diagnosis/search/search.h"

namespace ifog {

// Marks the effects of an acceleration, a temperature, a supply or a magnetic field whose size is beyond what
// gyros of this noise are sold with (FirstReading::kProxyShown): named, neither subtracted nor written. An
// effect's size is its swing over the swing of its channel. data: reconstructed.
void doubt_proxies(const BlockData& data, SearchResult& found);

// For people, a sentence for all of them; empty without.
std::string proxies_in_words(const BlockData& data, const SearchResult& found);

}  // namespace ifog
