// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/effective_tries.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "filters/distributions/chi_squared.h"
#include "filters/linear/symmetric.h"
#include "filters/random/philox.h"

namespace ifog {
namespace {

constexpr int kDraws = 2000;
constexpr double kQuantile = 0.98;

// A pair of normal deviates that depends on nothing but its place (Box and Muller).
std::pair<double, double> normal_pair(std::uint32_t draw, std::uint32_t place) {
  const PhiloxBlock bits = philox({draw, place, 0, 0}, {0x7261696eU, 0x74726965U});
  const double u = (bits[0] + 0.5) / 4294967296.0;
  const double turn = 2.0 * std::numbers::pi * (bits[1] + 0.5) / 4294967296.0;
  const double radius = std::sqrt(-2.0 * std::log(u));
  return {radius * std::cos(turn), radius * std::sin(turn)};
}

}  // namespace

double tail(double ratio, int columns) {
  if (ratio <= 0.0) return 1.0;
  return chi_squared_above(ratio, columns);
}

double independent_columns(const Columns& projected) {
  const Eigen::Index m = projected.cols();
  if (m < 2) return static_cast<double>(m);
  Eigen::VectorXd scale = projected.colwise().norm().transpose();
  for (double& s : scale) s = s > 0.0 ? 1.0 / s : 0.0;
  Eigen::MatrixXd correlation = scale.asDiagonal() * (projected.transpose() * projected) * scale.asDiagonal();
  correlation.diagonal().array() += 1e-6;  // columns can be alike to rounding
  const CholeskyFactor factor(correlation);
  Eigen::MatrixXd draws(m, kDraws);
  for (Eigen::Index d = 0; d < kDraws; ++d) {
    for (Eigen::Index i = 0; i < m; i += 2) {
      const auto [a, b] = normal_pair(static_cast<std::uint32_t>(d), static_cast<std::uint32_t>(i));
      draws(i, d) = a;
      if (i + 1 < m) draws(i + 1, d) = b;
    }
  }
  draws = factor.times(draws);
  std::vector<double> largest(kDraws);
  for (Eigen::Index d = 0; d < kDraws; ++d)
    largest[static_cast<std::size_t>(d)] = draws.col(d).cwiseAbs2().maxCoeff();
  const auto at = largest.begin() + static_cast<std::ptrdiff_t>(kQuantile * kDraws);
  std::nth_element(largest.begin(), at, largest.end());
  return std::clamp(-std::log(kQuantile) / tail(*at, 1), 1.0, static_cast<double>(m));
}

double independent_steps(const BlockGrid& grid, const NoiseShape& shape, double ratio) {
  double sum = 0.0;
  for (const BlockRange& record : grid.records) {
    const Eigen::VectorXd h = answer_to_step(grid, shape, record);
    const Eigen::Index length = h.size();
    // A step at a later block answers with the same series, cut short: of lengths n and n - 1.
    double energy = h[0] * h[0];
    double product = 0.0;
    for (Eigen::Index n = 1; n < length; ++n) {
      const double before = energy;
      energy += h[n] * h[n];
      product += h[n] * h[n - 1];
      const double correlation = product / std::sqrt(std::max(before * energy, 1e-300));
      sum += std::min(1.0, std::sqrt(ratio * std::max(0.0, 1.0 - correlation) / std::numbers::pi));
    }
    sum += 1.0;
  }
  return sum;
}

}  // namespace ifog
