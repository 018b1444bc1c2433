// SPDX-License-Identifier: Apache-2.0
// The covariance of a model's parameters: which of it a file has, and whether numbers read from one are such a
// matrix.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

// `values`: size × size, row by row; empty is unknown, and no flaw. "" or what is wrong, in words that name
// the row. Correlations are compared, so that units do not matter; what rounding does to a matrix of some
// hundred rows passes.
std::string covariance_flaw(const std::vector<double>& values, std::size_t size);

// Indices, among all parameters of the effects, of those whose covariances a file has: the parameters of effects
// that are corrected online. For what is only reported, such as a line, standard errors suffice.
std::vector<std::size_t> rows_in_file(const std::vector<Effect>& effects);

// The rows and columns `rows` of a size × size matrix.
std::vector<double> of_rows(const std::vector<double>& values, std::size_t size,
                            std::span<const std::size_t> rows);

// The other way: a file's matrix among all parameters of the effects, each of the others by its own error, as
// all are where it is empty.
std::vector<double> of_all_parameters(const std::vector<double>& in_file, const std::vector<Effect>& effects);

}  // namespace ifog
