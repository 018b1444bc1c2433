// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/between_captures.h"

#include <algorithm>
#include <cmath>

#include "filters/distributions/chi_squared.h"
#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

constexpr double kLevel = 1e-3;      // the noise, fitted to the same captures, is not known
constexpr double kMatters = 0.25;    // of the common coefficient
constexpr double kCertain = 4.0;     // standard errors
constexpr double kLeastMove = 1e-3;  // of the channel's regressor in the liveliest capture

// Of the effect's regressor about its mean, by record.
std::vector<double> moves_of(const BlockGrid& grid, const Eigen::VectorXd& column) {
  std::vector<double> moves;
  for (const BlockRange& record : grid.records) {
    const Eigen::VectorXd mine = column.segment(record.row(), record.rows());
    moves.push_back(std::sqrt((mine.array() - mine.mean()).square().sum()));
  }
  return moves;
}

ByCapture compare(const BlockData& data, const std::vector<Candidate>& effects, std::size_t at,
                  const NoiseFit& noise) {
  const BlockGrid& grid = data.grid;
  const Columns joint = design(data, effects);
  const Eigen::Index mine = column_of(grid, effects, at);
  const std::vector<double> moves = moves_of(grid, joint.col(mine));
  const double liveliest = *std::max_element(moves.begin(), moves.end());
  ByCapture found;
  found.effect = at;
  for (std::size_t r = 0; r < moves.size(); ++r)
    if (moves[r] > kLeastMove * liveliest) found.records.push_back(r);
  const auto count = static_cast<Eigen::Index>(found.records.size());
  if (count < 2) return found;
  Columns split(joint.rows(), joint.cols() - 1 + count);
  split << joint.leftCols(mine), joint.rightCols(joint.cols() - 1 - mine), Columns::Zero(joint.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const BlockRange& record = grid.records[found.records[static_cast<std::size_t>(i)]];
    split.col(joint.cols() - 1 + i).segment(record.row(), record.rows()) =
        joint.col(mine).segment(record.row(), record.rows());
  }
  // The noise that was fitted beside one coefficient for all has swallowed what they differ by.
  const NoiseFit beside = fit_noise(grid, split, noise.shape);
  Eigen::MatrixXd covariance;
  const Eigen::VectorXd all = solve(grid, beside.shape, split, &covariance);
  const Eigen::VectorXd value = all.tail(count);
  const Eigen::MatrixXd own = covariance.bottomRightCorner(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    found.value.push_back(value[i]);
    found.std_error.push_back(std::sqrt(own(i, i)));
  }
  const SymmetricSolver weight(own);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(count);
  const double common = weight.solve(one).dot(value) / weight.solve(one).dot(one);
  const Eigen::VectorXd away = value - common * one;
  const double square = std::max(0.0, away.dot(weight.solve(away)));
  found.p_value = chi_squared_above(square, static_cast<double>(count - 1));
  found.departure = away.cwiseAbs().maxCoeff() / std::max(std::abs(common), 1e-300);
  return found;
}

}  // namespace

bool ByCapture::changes() const { return p_value < kLevel && departure > kMatters; }

bool ByCapture::changes_sign() const {
  bool up = false;
  bool down = false;
  for (std::size_t i = 0; i < value.size(); ++i) {
    up = up || value[i] > kCertain * std_error[i];
    down = down || value[i] < -kCertain * std_error[i];
  }
  return up && down && changes();
}

std::vector<ByCapture> compare_captures(const BlockData& data, const std::vector<Candidate>& effects,
                                        const NoiseFit& noise) {
  std::vector<ByCapture> found;
  if (data.grid.records.size() < 2) return found;
  for (std::size_t i = 0; i < effects.size(); ++i)
    if (effects[i].channel != Candidate::kNone) found.push_back(compare(data, effects, i, noise));
  for (ByCapture& each : found)
    each.p_value = std::min(1.0, each.p_value * static_cast<double>(found.size()));
  return found;
}

}  // namespace ifog
