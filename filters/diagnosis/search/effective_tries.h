// SPDX-License-Identifier: Apache-2.0
// How many independent tries a search over correlated candidates amounts to. Counting every column and every
// position of a step would ask for far more than chance can do, and effects that are there would be missed.
#pragma once

#include <algorithm>
#include <cstddef>

#include "filters/diagnosis/regression/whitening.h"

namespace ifog {

// The noise is fitted anew under each candidate, from a record that holds few of its longest swings: chance
// then exceeds a likelihood ratio more often than with known noise. Of some 1500 simulated sensors without
// effects 0.7 % had one found at a level of 1 % with a factor of 3, so that a tenth of all samples of a
// thousand would have had more than 1 %.
inline constexpr double kProfiled = 5.0;

// Probability that chance makes twice the log-likelihood gained by `columns` regressors without an effect
// reach `ratio` (chi-square of that many degrees of freedom, 1 or 2).
double tail(double ratio, int columns);

// Neighbours among lags, powers and products of a channel correlate above 0.9: of so many columns a third is
// new.
inline double independent_columns(std::size_t columns) {
  return std::max(1.0, 0.3 * static_cast<double>(columns));
}

// Of the positions of a step in the grid's records under this noise. A score passes the level u on its way
// from one position to the next about u sqrt((1 - correlation) / pi) times as often as one position alone is
// above it (Rice's formula for neighbours; the bound of Hunter and Worsley to first order).
double independent_steps(const BlockGrid& grid, const NoiseShape& shape, double ratio);

}  // namespace ifog
