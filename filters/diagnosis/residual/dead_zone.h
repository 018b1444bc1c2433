// SPDX-License-Identifier: Apache-2.0
// Dead zone: a rate below which the sensor outputs only its bias, so the error is minus the rotation. A turn
// crosses it in a few samples. So it is detected in samples, relative to a mean over some seconds, before the
// effects of block means.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

struct DeadZone {
  double half_width = 0.0;  // rad/s
  double half_width_error = 0.0;
  double coefficient = 0.0;  // error / rate inside; -1 if no rotation is sensed
  double coefficient_error = 0.0;
  double ratio = 0.0;  // gain of twice the log-likelihood
  double p_value = 1.0;
};

// nullopt if chance or a single crossing explains it, or if the coefficient is not -1 (a scale factor).
// errors: residuals `rest`; rates: true rates on the same grid, by record, NaN missing; white_variance: of a
// sample.
std::optional<DeadZone> find_dead_zone(const std::vector<EvenError>& errors,
                                       const std::vector<Samples>& rates, double white_variance,
                                       double significance);

// Error that the dead zone causes, by sample; zero where the rate is missing.
Samples hidden_by(const DeadZone& zone, std::span<const double> rate);

// Subtracts the zone's error from the residuals and from the grid's block means.
void take_out(const DeadZone& zone, const std::vector<Samples>& rates, BlockGrid& grid,
              std::vector<EvenError>& errors);

}  // namespace ifog
