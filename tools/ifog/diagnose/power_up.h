// SPDX-License-Identifier: Apache-2.0
// Converts a warm-up from the time since the start of the record to the time since power-up.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// Time from power-up to the start of the fitted part, s; fit_from: skipped fraction of each capture. nullopt
// if a capture lacks it or they differ by more than 1 s.
[[nodiscard]] std::optional<double> began_after_power_up(const std::vector<CaptureView>& captures,
                                                         double fit_from = 0.0);

// a exp(-t / tau) of a record that began t0 after power-up equals a exp(t0 / tau) exp(-(t0 + t) / tau).
// Converts coefficients, their errors and the covariance of all parameters, by the derivatives.
void count_from_power_up(Diagnosis& diagnosis, double began_s);

}  // namespace ifog::tools
