// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "filters/linear/least_squares.h"
#include "filters/linear/projection.h"

namespace ifog {
namespace {

constexpr int kFolds = 4;
constexpr int kDwellFolds = 10;

int fold_count(const BlockGrid& grid) { return grid.dwells ? kDwellFolds : kFolds; }

// Fold of each block: contiguous pieces, of a time series four short ones for each fold, alternating, so that every fold
// covers the whole record.
std::vector<int> fold_of_block(const BlockGrid& grid) {
  const auto folds = static_cast<std::size_t>(fold_count(grid));
  const std::size_t pieces = (grid.dwells ? 1 : 4) * folds;
  std::vector<int> fold(grid.size());
  for (const BlockRange& record : grid.records)
    for (std::size_t b = 0; b < record.size(); ++b)
      fold[record.first + b] = static_cast<int>(b * pieces / record.size() % folds);
  return fold;
}

// Least squares on the residual of the regressors without one fold.
Eigen::VectorXd without_fold(Columns white, const std::vector<int>& fold, int held_out) {
  const Eigen::Index p = white.cols() - 1;
  const Eigen::VectorXd full = white.rightCols(p).colwise().norm().transpose().cwiseMax(1e-300);
  for (Eigen::Index i = 0; i < white.rows(); ++i) {
    if (fold[static_cast<std::size_t>(i)] == held_out) white.row(i).setZero();
  }
  const Columns x = white.rightCols(p);
  // An effect that happened only in the held-out fold gets no coefficient.
  Eigen::VectorXd scale = x.colwise().norm().transpose();
  for (Eigen::Index j = 0; j < p; ++j) scale[j] = scale[j] > 1e-3 * full[j] ? 1.0 / scale[j] : 0.0;
  const Eigen::MatrixXd scaled = x * scale.asDiagonal();
  return scale.asDiagonal() * shortest_coefficients(scaled, white.col(0));
}

// For each held-out part, fitted on the other parts. Zero for an effect that happened only in the held-out part.
std::vector<Eigen::VectorXd> coefficients_without_each_fold(const BlockGrid& grid, const NoiseShape& shape,
                                                            const Columns& columns,
                                                            const std::vector<int>& fold) {
  // Whitened on all blocks, then fitted on the other folds' rows: a fold is excluded from the fit but not
  // from the filter, which would restart after every gap. The constants are projected out on all blocks.
  Columns white = columns;
  Whitening(grid, shape).apply(white);
  const Eigen::Index k = grid.constants();
  Columns others(white.rows(), white.cols() - k);
  others << white.col(0), white.rightCols(white.cols() - 1 - k);
  Projection(white.middleCols(1, k)).take_out_of(others);
  std::vector<Eigen::VectorXd> coefficients;
  for (int f = 0; f < fold_count(grid); ++f) coefficients.push_back(without_fold(others, fold, f));
  return coefficients;
}

}  // namespace

Eigen::VectorXd held_out_change(const BlockData& data, const std::vector<Candidate>& effects,
                                const NoiseShape& shape, const Eigen::VectorXd& coefficients) {
  const BlockGrid& grid = data.grid;
  const Columns columns = design(data, effects);
  const Eigen::Index p = columns.cols() - 1 - grid.constants();
  const std::vector<int> fold = fold_of_block(grid);
  const std::vector<Eigen::VectorXd> others = coefficients_without_each_fold(grid, shape, columns, fold);
  Columns centred = columns.rightCols(p);
  centre_records(grid, centred);
  for (std::size_t i = 0; i < effects.size(); ++i)
    if (!effects[i].corrected()) centred.col(static_cast<Eigen::Index>(i)).setZero();
  Eigen::VectorXd change(columns.rows());
  for (Eigen::Index b = 0; b < change.size(); ++b) {
    const auto held_out = static_cast<std::size_t>(fold[static_cast<std::size_t>(b)]);
    change[b] = centred.row(b).dot(others[held_out] - coefficients);
  }
  return change;
}

namespace {

// Required difference of the means before and after, as a share of the step: of the whole means and of the
// halves farther from the step.
constexpr double kLasting = 0.4;
constexpr double kLastingFar = 0.25;
// Required square of a coefficient over its standard error as its scatter between the folds shows it. In motion the
// reference has errors of its own that grow with the rate (delay, smoothing, flexing), so that one stretch makes a
// coefficient many standard errors large. Student's t of three degrees of freedom exceeds 4 in 3 of 100 cases.
constexpr double kAlikeInFolds = 16.0;

}  // namespace

bool predicts_held_out(const BlockData& data, const FittedModel& model) {
  Columns white = design(data, model.effects);
  Whitening(data.grid, model.noise.shape).apply(white);
  const Eigen::Index last = white.cols() - 1;
  const Projection others(white.middleCols(1, last - 1));
  Eigen::VectorXd y = white.col(0);
  Eigen::VectorXd x = white.col(last);
  others.take_out_of(y);
  others.take_out_of(x);
  const std::vector<int> fold = fold_of_block(data.grid);
  const auto folds = static_cast<std::size_t>(fold_count(data.grid));
  std::vector<double> xy(folds, 0.0), xx(folds, 0.0);
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const auto f = static_cast<std::size_t>(fold[static_cast<std::size_t>(i)]);
    xy[f] += x[i] * y[i];
    xx[f] += x[i] * x[i];
  }
  const double all_xy = std::accumulate(xy.begin(), xy.end(), 0.0);
  const double all_xx = std::accumulate(xx.begin(), xx.end(), 0.0);
  double gain = 0.0, scatter = 0.0;
  for (std::size_t f = 0; f < folds; ++f) {
    if (xx[f] > 0.0) scatter += std::pow(xy[f] - all_xy / all_xx * xx[f], 2) / xx[f];
    if (all_xx - xx[f] <= 0.0) continue;
    const double c = (all_xy - xy[f]) / (all_xx - xx[f]);
    gain += 2.0 * c * xy[f] - c * c * xx[f];
  }
  if (data.reference < 0 || data.grid.dwells) return gain > 0.0;
  return gain > 0.0 && all_xy * all_xy / all_xx > kAlikeInFolds * scatter / (kFolds - 1);
}

bool step_persists(const BlockData& data, const FittedModel& model) {
  const BlockGrid& grid = data.grid;
  const Candidate& step = model.effects.back();
  const Columns columns = design(data, model.effects);
  const Eigen::VectorXd c = fit_whitened(grid, model.noise.shape, columns).coefficients();
  const Eigen::Index last = columns.cols() - 1;
  // Other steps remain: of two that cancel, neither lasts.
  Eigen::VectorXd taken = c.head(last - 1);
  for (std::size_t i = 0; i + 1 < model.effects.size(); ++i)
    if (model.effects[i].form == Form::kStep) taken[column_of(grid, i) - 1] = 0.0;
  const BlockRange& record = grid.records[step.record];
  const std::size_t window = std::max<std::size_t>(8, record.size() / 20);
  // Before and after, from the nearest block on: a hole may lie between them.
  std::array<std::vector<double>, 2> level;
  const auto look_at = [&](std::size_t b) {
    const auto row = static_cast<Eigen::Index>(b);
    std::vector<double>& side = level[grid.time_s[b] > step.time_s ? 1 : 0];
    if (grid.valid[b] && std::abs(grid.time_s[b] - step.time_s) >= 3.0 * grid.block_s && side.size() < window)
      side.push_back(columns(row, 0) - columns.row(row).segment(1, last - 1).dot(taken));
  };
  for (std::size_t b = record.end; b > record.first; --b)
    if (grid.time_s[b - 1] <= step.time_s) look_at(b - 1);
  for (std::size_t b = record.first; b < record.end; ++b)
    if (grid.time_s[b] > step.time_s) look_at(b);
  if (level[0].size() < 8 || level[1].size() < 8) return false;
  const auto change = [&](bool far) {
    const auto mean = [&](const std::vector<double>& side) {
      const auto from = side.begin() + static_cast<std::ptrdiff_t>(far ? side.size() / 2 : 0);
      return std::accumulate(from, side.end(), 0.0) / static_cast<double>(side.end() - from);
    };
    return (mean(level[1]) - mean(level[0])) / c[last - 1];
  };
  return change(false) > kLasting && change(true) > kLastingFar;
}

}  // namespace ifog
