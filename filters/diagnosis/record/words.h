// SPDX-License-Identifier: Apache-2.0
// Sentences with figures in them, and what is usual among many.
#pragma once

#include <string>
#include <vector>

namespace ifog {

// As std::printf.
[[gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...);

// At least one value.
double median(std::vector<double> values);

}  // namespace ifog
