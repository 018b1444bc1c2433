// SPDX-License-Identifier: Apache-2.0
// Covariance of a model's parameters: the part stored in a file, and the validation of a matrix read from
// one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

// "" or a description of the error with the row. values: size × size, by rows; empty is valid and means
// unknown. Correlations are checked, so units do not matter; rounding errors of some hundred rows are
// tolerated.
std::string covariance_flaw(const std::vector<double>& values, std::size_t size);

// Indices, among all parameters of the effects, of those in a file's covariance: the parameters of effects
// that are corrected online. For other effects, such as lines, standard errors suffice.
std::vector<std::size_t> rows_in_file(const std::vector<Effect>& effects);

// Submatrix of these rows and columns of a size × size matrix.
std::vector<double> of_rows(const std::vector<double>& values, std::size_t size,
                            std::span<const std::size_t> rows);

// Inverse of rows_in_file(): the file's matrix among all parameters. Other parameters, or all if it is empty,
// get their own standard errors.
std::vector<double> of_all_parameters(const std::vector<double>& in_file, const std::vector<Effect>& effects);

}  // namespace ifog
