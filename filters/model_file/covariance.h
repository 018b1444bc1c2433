// SPDX-License-Identifier: Apache-2.0
// Whether numbers read from outside are a covariance matrix.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ifog {

// `values`: size × size, row by row; empty is unknown, and no flaw. "" or what is wrong, in words that name
// the row. Correlations are compared, so that units do not matter; what rounding does to a matrix of some
// hundred rows passes.
std::string covariance_flaw(const std::vector<double>& values, std::size_t size);

}  // namespace ifog
