// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/chow_test.h"

#include <algorithm>
#include <array>

#include "filters/linear/least_squares.h"

namespace ifog {
namespace {

constexpr std::size_t kParts = 4;

}  // namespace

Unsteadiness unsteadiness(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                          const NoiseShape& shape) {
  Columns white = design(data, model);
  Whitening(data.grid, shape).apply(white);
  const Eigen::Index p = white.cols() - 1;
  const Eigen::Index mine = column_of(data.grid, model, at);
  Columns others(white.rows(), p - 1);
  others << white.middleCols(1, mine - 1), white.rightCols(p - mine);
  const Eigen::VectorXd x = left_by(others, white.col(mine));
  const Eigen::VectorXd left = left_by(white.rightCols(p), white.col(0));
  const double variance = left.squaredNorm() /
                          std::max(1.0, static_cast<double>(static_cast<Eigen::Index>(data.grid.used()) - p));
  const double all = x.squaredNorm();
  if (!(all > 0.0)) return {};

  struct Part {
    double moment = 0.0, energy = 0.0, scatter = 0.0;
  };
  std::array<Part, kParts> parts;
  double energy = 0.0;
  for (Eigen::Index row = 0; row < x.size(); ++row) {
    Part& part = parts[std::min(kParts - 1, static_cast<std::size_t>(kParts * energy / all))];
    const double square = x[row] * x[row];
    part.moment += x[row] * left[row];
    part.energy += square;
    part.scatter += square * left[row] * left[row];
    energy += square;
  }
  // Coefficients and the weights of their variances.
  const double whole = x.dot(white.col(0)) / all;
  std::array<double, kParts> coefficient{};
  std::array<double, kParts> weight{};
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t i = 0; i < kParts; ++i) {
    const Part& part = parts[i];
    if (!(part.energy > 0.0)) continue;
    coefficient[i] = whole + part.moment / part.energy;
    weight[i] = part.energy * part.energy / std::max(part.scatter, part.energy * variance);
    sum += weight[i] * coefficient[i];
    weights += weight[i];
  }
  const double common = sum / weights;
  Unsteadiness found;
  for (std::size_t i = 0; i < kParts; ++i) found.square += weight[i] * std::pow(coefficient[i] - common, 2);
  found.share = found.square / (found.square + weights * common * common);
  return found;
}

}  // namespace ifog
