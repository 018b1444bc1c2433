// SPDX-License-Identifier: Apache-2.0
// A rate below which the sensor sees none: what it says there is its bias, and the error is the rotation that
// it missed. A turn passes through in a few samples, so it is sought in the samples themselves, about a mean
// of a few seconds, before the effects of block means.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

struct DeadZone {
  double half_width = 0.0;  // rad/s
  double half_width_error = 0.0;
  double coefficient = 0.0;  // error over rate inside: -1 where nothing is seen
  double coefficient_error = 0.0;
  double ratio = 0.0;  // twice the log-likelihood gained
  double p_value = 1.0;
};

// errors: what is left, `rest`. rates: true ones on the same grid, by record; NaN missing. white_variance: of
// a sample's noise. Nothing where chance or one passage alone would do as well, or where the coefficient is
// another than -1, as that of a scale factor is.
std::optional<DeadZone> find_dead_zone(const std::vector<EvenError>& errors,
                                       const std::vector<Samples>& rates, double white_variance,
                                       double significance);

// What the zone makes of a rate, sample by sample; zero where that is missing.
Samples hidden_by(const DeadZone& zone, std::span<const double> rate);

// Out of the rest of the errors, and of the means over the grid's blocks.
void take_out(const DeadZone& zone, const std::vector<Samples>& rates, BlockGrid& grid,
              std::vector<EvenError>& errors);

}  // namespace ifog
