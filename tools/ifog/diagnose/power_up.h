// SPDX-License-Identifier: Apache-2.0
// A warm-up is found by the time since the record began; a model has it by the time since power-up.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// How long after power-up what was fitted of all of them began, s; fit_from: the share of each one's time
// that was skipped before. None where one does not know, or they differ by over a second.
[[nodiscard]] std::optional<double> began_after_power_up(const std::vector<CaptureView>& captures,
                                                         double fit_from = 0.0);

// a exp(-t / tau) of a record that began t0 after power-up is a exp(t0 / tau) exp(-(t0 + t) / tau):
// coefficients, their errors and the covariance of all parameters, which go along by the derivatives.
void count_from_power_up(Diagnosis& diagnosis, double began_s);

}  // namespace ifog::tools
