// SPDX-License-Identifier: Apache-2.0
// Earth's rate in a gyro that tilts. It is rotation, and is the first interpretation of an effect of
// acceleration of at most its size.
//
// An axis tilted by t on one heading senses Omega (cos(latitude) cos(heading) cos t + sin(latitude) sin t),
// an accelerometer g sin t or g cos t. So the rate is linear in the acceleration by at most Omega/g and
// quadratic by at most Omega/g^2. On one heading this cannot be distinguished from g-sensitivity, and
// correcting it would be wrong on another heading.
#pragma once

#include <optional>
#include <string>

#include "filters/diagnosis/search/search.h"

namespace ifog {

struct EarthRateOptions {
  bool subtract = false;
  std::optional<double> latitude_rad;
  // "x" if known: the accelerometer along it depends on the vertical part, the others on the horizontal part
  std::string axis;
};

// True if the acceleration channel can be tilt: the magnitude of the triad stays at g, or, for a single
// accelerometer, it stays within g.
bool may_be_tilt(const BlockData& data, std::size_t channel);

// Largest slope of a linear (or lagged) effect of this acceleration that the Earth's rate can cause, rad/s
// per unit of the channel.
double largest_earth_rate(const std::string& channel, const EarthRateOptions& options);

// Sets FirstReading of effects of acceleration whose coefficients are within the Earth's rate plus two
// standard errors. data: reconstructed.
void read_as_earth_rate(const BlockData& data, const EarthRateOptions& options, SearchResult& found);

// Sentence for users: which effects may be the Earth's rate, and which capture would decide; or empty.
std::string earth_rate_in_words(const BlockData& data, const EarthRateOptions& options,
                                const SearchResult& found);

}  // namespace ifog
