// SPDX-License-Identifier: Apache-2.0
// Several captures of one sensor, compared coefficient by coefficient: an effect of the sensor's own is the
// same in all of them, and what only ran beside a channel once is not.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// One effect, fitted to each capture by itself, all else to all of them.
struct ByCapture {
  std::size_t effect = 0;
  std::vector<std::size_t> records;      // those that its channel moves in
  std::vector<double> value, std_error;  // of its coefficient, by those
  double p_value = 1.0;    // of one coefficient for all, after correction for the effects compared
  double departure = 0.0;  // the largest from the common coefficient, as a share of it
  [[nodiscard]] bool changes_sign() const;  // two of them, each certain
  [[nodiscard]] bool changes() const;       // more than chance does, and by a size that matters
};

// Effects of a channel only; empty with one record. data: reconstructed.
std::vector<ByCapture> compare_captures(const BlockData& data, const std::vector<Candidate>& effects,
                                        const NoiseFit& noise);

}  // namespace ifog
