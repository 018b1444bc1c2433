// SPDX-License-Identifier: Apache-2.0
// Figures of an error series for the comparison before / after.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "filters/series/samples.h"

namespace ifog {

// Keys: residual_rms_radps, rms_<T>s_radps and adev_<T>s_radps for T of 0.1, 1, 10 and 100,
// heading_drift_rad, whiteness. Averaging times of which the record has fewer than ten are omitted. Heading
// drift: angle error at the end if the bias is the mean of the first tenth. Whiteness: autocorrelation at lag
// 1 of 1 s means (or longer samples); 0 for white noise. error: equidistant with period_s, NaN missing.
std::map<std::string, double> error_figures(std::span<const double> error, double period_s);

// Figures of several records of one sensor: squares and whiteness averaged with weights by length.
std::map<std::string, double> pooled(const std::vector<std::map<std::string, double>>& figures,
                                     const std::vector<double>& weights);

// Means over `count` samples, NaN if fewer than half are present.
Samples means_over(std::span<const double> error, std::size_t count);

}  // namespace ifog
