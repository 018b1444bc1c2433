// SPDX-License-Identifier: Apache-2.0
// A device that sends at another rate than it should, in words.
#pragma once

#include <string>

namespace ifog {

// interval_error: the fitted period over the nominal one, less 1; held by the fit between half and twice the
// nominal period, beyond which the rate is the counted one. counted_hz: samples by the second, of now.
std::string wrong_rate_in_words(double nominal_hz, double interval_error, double counted_hz);

}  // namespace ifog
