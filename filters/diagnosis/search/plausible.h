// SPDX-License-Identifier: Apache-2.0
// Compares coefficients with makers' specifications. A channel that drifts like an unlogged temperature or
// ageing explains the bias with a coefficient that no gyro has. On the next capture its correction would be
// far larger than the error.
#pragma once

#include <string>

#include "filters/diagnosis/search/search.h"

namespace ifog {

// Marks effects of acceleration, temperature, supply or magnetic field that exceed the specifications of
// gyros with this noise (FirstReading::kProxyShown): reported, not corrected or written. Size of an effect:
// its range over the range of its channel. data: reconstructed.
// Without a reference also the effects of a channel without a specification that exceed what any bias does.
void doubt_proxies(const BlockData& data, SearchResult& found);

// One sentence on all of them for users; empty if there is none.
std::string proxies_in_words(const BlockData& data, const SearchResult& found);

}  // namespace ifog
