// SPDX-License-Identifier: Apache-2.0
// The figures of an error series by which before and after are compared, and what the series looks like.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "filters/series/samples.h"

namespace ifog {

// Even steps of period_s; NaN missing. Keys: residual_rms_radps, rms_<T>s_radps and adev_<T>s_radps for T of
// 0.1, 1, 10 and 100, heading_drift_rad, whiteness. Averaging times that the record does not hold ten of are
// left out. Heading drift: error of the angle at the end when the bias is the mean of the first tenth.
// Whiteness: lag-1 autocorrelation of 1 s means (of samples, if those are longer); 0 for white noise.
std::map<std::string, double> error_figures(std::span<const double> error, double period_s);

// Several records of one sensor: squares averaged by length, whiteness by length.
std::map<std::string, double> pooled(const std::vector<std::map<std::string, double>>& figures,
                                     const std::vector<double>& weights);

// Means over `count` samples, NaN where fewer than half are there.
Samples means_over(std::span<const double> error, std::size_t count);

}  // namespace ifog
