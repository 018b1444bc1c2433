// SPDX-License-Identifier: Apache-2.0
// What stays, in words a person can act on.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/residual/lines.h"

namespace ifog {

// error, left: before and after, even steps of period_s, NaN missing, of one record starting at start_s.
// peaks: spectral peaks of `left` that are no lines of one phase; changes: of its noise.
Unexplained describe_unexplained(std::span<const double> error, std::span<const double> left, double start_s,
                                 double period_s, const NoiseFit& noise, const BlockGrid& grid,
                                 const std::vector<SpectralLine>& peaks,
                                 std::span<const NoiseChange> changes = {});

// Describes the longest record's error. Peaks are sought in what is left (none on a rate table).
Unexplained describe_rest(const std::vector<EvenError>& errors, const NoiseFit& noise, const BlockGrid& grid,
                          double significance, const std::vector<NoiseChangeIn>& noise_changes);

// A loop takes the description's place.
void describe_hysteresis(const Hysteresis& loop, Unexplained& found);

}  // namespace ifog
