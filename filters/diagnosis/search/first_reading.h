// SPDX-License-Identifier: Apache-2.0
// First interpretation of the effects found: the Earth's rate in a gyro that tilts, and proxies.
//
// An axis tilted by t on one heading senses Omega (cos(latitude) cos(heading) cos t + sin(latitude) sin t),
// an accelerometer g sin t or g cos t. So the rate is linear in the acceleration by at most Omega/g and
// quadratic by at most Omega/g^2. On one heading this cannot be distinguished from g-sensitivity, and
// correcting it would be wrong on another heading.
//
// A channel that drifts like an unlogged temperature or ageing explains the bias with a coefficient that no gyro
// has, by makers' specifications. On the next capture its correction would be far larger than the error.
#pragma once

#include <string>

#include "filters/diagnosis/search/search.h"

namespace ifog {

// Sets FirstReading of effects of acceleration whose coefficients are within the Earth's rate plus two
// standard errors, if the channel can be tilt. data: reconstructed.
void read_as_earth_rate(const BlockData& data, const DiagnoseOptions& options, SearchResult& found);

// Sentence for users: which effects may be the Earth's rate, and which capture would decide; or empty.
std::string earth_rate_in_words(const DiagnoseOptions& options, const BlockData& data,
                                const SearchResult& found);

// Marks effects of acceleration, temperature, supply or magnetic field that exceed the specifications of
// gyros with this noise (FirstReading::kProxyShown): reported, not corrected or written. Size of an effect:
// its range over the range of its channel. data: reconstructed.
// Without a reference also the effects of a channel without a specification that exceed what any bias does.
void doubt_proxies(const BlockData& data, SearchResult& found);

// One sentence on all of them for users; empty if there is none.
std::string proxies_in_words(const BlockData& data, const SearchResult& found);

}  // namespace ifog
