// SPDX-License-Identifier: Apache-2.0
// Whether the lines of one capture stand in another one where the rate there puts them, or where they were.
// At rest in one capture nothing tells a feedback ramp's lines from a machine's; two rates do.
#pragma once

#include "filters/diagnosis/ramp/ramp_comb.h"

namespace ifog {

struct RampBetween {
  bool moves = false;           // with the rate, by k, and does not stand
  double cycles_per_rad = 0.0;  // k as the other capture has it
  double gain = 0.0;            // twice the log-likelihood of the harmonics there
  double over_standing = 0.0;   // beyond the same harmonics at the first capture's frequencies
};

// comb: found in `first`. Nothing is said (moves is false) where the rates are too much alike to tell.
RampBetween follow_comb(const UnbrokenPart& first, const RampComb& comb, const UnbrokenPart& other);

}  // namespace ifog
