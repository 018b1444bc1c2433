// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/outliers.h"

#include <algorithm>
#include <cmath>

#include "filters/linear/least_squares.h"

namespace ifog {
namespace {

constexpr double kFar = 4.0;
constexpr double kMedianOfNormal = 0.6744897501960817;  // of |x|, x unit normal

}  // namespace

double ratio_in_changing_noise(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                               const NoiseShape& shape) {
  Columns white = design(data, model);
  Whitening(data.grid, shape).apply(white);
  const Eigen::Index mine = column_of(data.grid, model, at);
  const Eigen::Index p = white.cols() - 1;
  Columns others(white.rows(), p - 1);
  others << white.middleCols(1, mine - 1), white.rightCols(p - mine);
  const Eigen::VectorXd x = left_by(others, white.col(mine));
  const Eigen::VectorXd left = left_by(white.rightCols(p), white.col(0));
  const Eigen::VectorXd score = x.cwiseProduct(left);
  double variance = score.squaredNorm();
  const auto lags = static_cast<Eigen::Index>(std::cbrt(static_cast<double>(score.size())));
  for (Eigen::Index lag = 1; lag <= lags; ++lag) {
    const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    variance += 2.0 * weight * score.head(score.size() - lag).dot(score.tail(score.size() - lag));
  }
  const double moment = x.dot(white.col(0));
  return moment * moment / std::max(variance, 1e-300);
}

double ratio_without_outliers(const BlockData& data, const std::vector<Candidate>& model, std::size_t at,
                              const NoiseShape& shape) {
  const BlockGrid& grid = data.grid;
  Columns white = design(data, model);
  Whitening(grid, shape).apply(white);
  const Eigen::Index p = white.cols() - 1;
  const Eigen::VectorXd left = left_by(white.rightCols(p), white.col(0));
  std::vector<double> size;
  for (std::size_t b = 0; b < grid.size(); ++b) {
    if (grid.valid[b]) size.push_back(std::abs(left[static_cast<Eigen::Index>(b)]));
  }
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  const double far = kFar * *middle / kMedianOfNormal;
  Columns kept(white.rows(), white.cols());
  Eigen::Index n = 0;
  for (std::size_t b = 0; b < grid.size(); ++b) {
    const auto row = static_cast<Eigen::Index>(b);
    if (grid.valid[b] && std::abs(left[row]) <= far) kept.row(n++) = white.row(row);
  }
  kept.conservativeResize(n, Eigen::NoChange);
  const Eigen::Index from = column_of(data.grid, model, at);
  const Eigen::Index width = model[at].width();
  Columns without(n, p - width);
  without << kept.middleCols(1, from - 1), kept.rightCols(p + 1 - from - width);
  const double with_it = left_by(kept.rightCols(p), kept.col(0)).squaredNorm();
  const double without_it = left_by(without, kept.col(0)).squaredNorm();
  return static_cast<double>(n) * std::log(without_it / std::max(with_it, 1e-300));
}

}  // namespace ifog
