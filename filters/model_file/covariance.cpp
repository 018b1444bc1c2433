// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/covariance.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace ifog {
namespace {

constexpr double kRounding = 1e-6;  // of a correlation

std::string place(std::size_t row, std::size_t column) {
  return "row " + std::to_string(row + 1) + ", column " + std::to_string(column + 1);
}

}  // namespace

std::string covariance_flaw(const std::vector<double>& values, std::size_t size) {
  if (values.empty()) return "";
  const auto at = [&](std::size_t row, std::size_t column) { return values[row * size + column]; };
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t i = 0; i < size; ++i) {
    if (at(i, i) < 0.0) return "a negative variance in " + place(i, i);
    for (std::size_t j = 0; j < i; ++j) {
      const double scale = std::sqrt(at(i, i)) * std::sqrt(at(j, j));
      // A parameter that is known exactly goes with no other.
      if (scale == 0.0 ? at(i, j) != 0.0 || at(j, i) != 0.0
                       : !(std::abs(at(i, j)) <= scale * (1.0 + kRounding)))
        return "more than the variances allow in " + place(i, j);
      if (!(std::abs(at(i, j) - at(j, i)) <= kRounding * scale))
        return place(i, j) + " differs from " + place(j, i);
      if (scale > 0.0)
        correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = at(i, j) / scale;
    }
  }
  // Positive semidefinite but for rounding: with that much more on the diagonal it has a Cholesky factor.
  correlation.diagonal().array() += kRounding * static_cast<double>(size);
  return correlation.llt().info() == Eigen::Success ? ""
                                                    : "a combination of parameters has a negative variance";
}

}  // namespace ifog
