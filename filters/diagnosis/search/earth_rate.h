// SPDX-License-Identifier: Apache-2.0
// The Earth's rate in a gyro that tilts: rotation, and the first reading of an effect of acceleration that is
// not larger than it can be.
//
// Tilted by t on one heading an axis sees Omega (cos(latitude) cos(heading) cos t + sin(latitude) sin t), and
// an accelerometer g sin t or g cos t: a straight line in the acceleration of at most Omega/g, and a curve of
// at most Omega/g^2. No record of one heading tells that from g-sensitivity of the same size, and a
// correction that takes rotation away is wrong on the next heading.
#pragma once

#include <optional>
#include <string>

#include "filters/diagnosis/search/search.h"

namespace ifog {

struct EarthRateOptions {
  bool subtract = false;
  std::optional<double> latitude_rad;
  // "x", when known: an accelerometer along it goes with the vertical part, others with the horizontal one.
  std::string axis;
};

// Whether what an accelerometer says can be tilt: together with the others it stays at g as it changes. One
// alone that stays within g leaves that open: true. channel: an acceleration.
bool may_be_tilt(const BlockData& data, std::size_t channel);

// Largest slope that the Earth's rate gives a linear (or lagged) effect of this acceleration, rad/s per unit of
// the channel.
double largest_earth_rate(const std::string& channel, const EarthRateOptions& options);

// Sets the reading of the effects of acceleration that the Earth's rate would explain, within two standard
// errors of their coefficients. data: reconstructed.
void read_as_earth_rate(const BlockData& data, const EarthRateOptions& options, SearchResult& found);

// Sentence for users: what is read as the Earth's rate, and which capture would show it. Empty if nothing is.
std::string earth_rate_in_words(const BlockData& data, const EarthRateOptions& options,
                                const SearchResult& found);

}  // namespace ifog
