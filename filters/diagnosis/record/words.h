// SPDX-License-Identifier: Apache-2.0
// Sentences with figures in them, and what is usual among many.
#pragma once

#include <string>
#include <vector>

namespace ifog {

// As std::printf.
[[gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...);

// Below which that share of the values lies; at least one value.
double quantile(std::vector<double>& values, double share);
double median(std::vector<double> values);

}  // namespace ifog
