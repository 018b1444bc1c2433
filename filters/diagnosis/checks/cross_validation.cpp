// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/cross_validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "filters/linear/least_squares.h"
#include "filters/linear/projection.h"

namespace ifog {
namespace {

constexpr int kFolds = 4;
constexpr int kDwellFolds = 10;

int fold_count(const BlockGrid& grid) { return grid.dwells ? kDwellFolds : kFolds; }

std::vector<int> fold_of_block(const BlockGrid& grid) {
  return grid.dwells ? folds_of(grid, kDwellFolds, 1) : folds_of(grid, kFolds);
}

// Least squares of the measurement on what is left of the regressors without one fold.
Eigen::VectorXd without_fold(Columns white, const std::vector<int>& fold, int held_out) {
  const Eigen::Index p = white.cols() - 1;
  const Eigen::VectorXd full = white.rightCols(p).colwise().norm().transpose().cwiseMax(1e-300);
  for (Eigen::Index i = 0; i < white.rows(); ++i) {
    if (fold[static_cast<std::size_t>(i)] == held_out) white.row(i).setZero();
  }
  const Columns x = white.rightCols(p);
  // What happened in the held-out fold alone, the others cannot know: no coefficient.
  Eigen::VectorXd scale = x.colwise().norm().transpose();
  for (Eigen::Index j = 0; j < p; ++j) scale[j] = scale[j] > 1e-3 * full[j] ? 1.0 / scale[j] : 0.0;
  const Eigen::MatrixXd scaled = x * scale.asDiagonal();
  return scale.asDiagonal() * shortest_coefficients(scaled, white.col(0));
}

// What is smooth at a sample, from means over blocks: straight lines between means would leave of a swing
// what beats with the blocks (a hundredth of it at ten blocks a period, where this leaves a thousandth), and
// that is a line.
class BetweenBlocks {
 public:
  // values: by block. Blocks of one sample, and dwells, are taken as they are.
  BetweenBlocks(const BlockGrid& grid, const BlockRange& record, const Eigen::VectorXd& values)
      : values_(values.segment(record.row(), record.rows())) {
    const bool means = !grid.dwells && grid.block_s > 1.5 * grid.sample_s;
    const Eigen::Index n = values_.size();
    if (!means || n < 4) return;
    // A mean lies off its middle by the curvature over 24.
    const Eigen::VectorXd curvature =
        values_.head(n - 2) - 2.0 * values_.segment(1, n - 2) + values_.tail(n - 2);
    values_.segment(1, n - 2) -= curvature / 24.0;
    cubic_ = true;
  }

  // at: in blocks from the middle of the first.
  [[nodiscard]] double operator()(double at) const {
    const Eigen::Index last = values_.size() - 1;
    const double place = std::clamp(at, 0.0, static_cast<double>(last));
    const auto low = static_cast<Eigen::Index>(place);
    const Eigen::Index high = std::min(low + 1, last);
    const double x = place - static_cast<double>(low);
    const double straight = values_[low] + x * (values_[high] - values_[low]);
    if (!cubic_ || low < 1 || low + 2 > last || x == 0.0) return straight;
    // Lagrange's cubic through four.
    const double before = values_[low - 1], beyond = values_[low + 2];
    return -x * (x - 1.0) * (x - 2.0) / 6.0 * before +
           (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0 * values_[low] -
           (x + 1.0) * x * (x - 2.0) / 2.0 * values_[high] + (x + 1.0) * x * (x - 1.0) / 6.0 * beyond;
  }

 private:
  Eigen::VectorXd values_;
  bool cubic_ = false;
};

// By block, each from the coefficients of the others' folds; a step or a line helps to fit them and is then
// left where it is, as online. Each fold's fit has a constant of its own: without it a channel far from zero
// would step from fold to fold.
// second: by the coefficients of all folds.
std::pair<Eigen::VectorXd, Eigen::VectorXd> held_out_effects(const BlockGrid& grid, const NoiseShape& shape,
                                                             const Columns& columns,
                                                             const std::vector<Candidate>& effects,
                                                             const Eigen::VectorXd& of_all) {
  const std::vector<Eigen::VectorXd> coefficients = coefficients_without_each_fold(grid, shape, columns);
  const std::vector<int> fold = fold_of_block(grid);
  Columns centred = columns.rightCols(columns.cols() - 1 - grid.constants());
  centre_records(grid, centred);
  Eigen::Index at = 0;
  for (const Candidate& effect : effects) {
    if (!effect.corrected()) centred.middleCols(at, effect.width()).setZero();
    at += effect.width();
  }
  Eigen::VectorXd sum(columns.rows());
  for (Eigen::Index b = 0; b < sum.size(); ++b) {
    const auto held_out = static_cast<std::size_t>(fold[static_cast<std::size_t>(b)]);
    sum[b] = centred.row(b).dot(coefficients[held_out]);
  }
  return {sum, centred * of_all};
}

}  // namespace

std::vector<Eigen::VectorXd> coefficients_without_each_fold(const BlockGrid& grid, const NoiseShape& shape,
                                                            const Columns& columns) {
  // Whitened on all blocks, then fitted on the rows of the others: a fold is left out of the fit, not cut
  // out of the filter, which would start anew behind every gap. The constants are projected out on all
  // blocks.
  Columns white = columns;
  Whitening(grid, shape).apply(white);
  const Eigen::Index k = grid.constants();
  Columns others(white.rows(), white.cols() - k);
  others << white.col(0), white.rightCols(white.cols() - 1 - k);
  Projection(white.middleCols(1, k)).take_out_of(others);
  const std::vector<int> fold = fold_of_block(grid);
  std::vector<Eigen::VectorXd> coefficients;
  coefficients.reserve(static_cast<std::size_t>(fold_count(grid)));
  for (int f = 0; f < fold_count(grid); ++f) coefficients.push_back(without_fold(others, fold, f));
  return coefficients;
}

void subtract_effects(const BlockData& data, const std::vector<Candidate>& effects, const NoiseShape& shape,
                      const Eigen::VectorXd& coefficients, std::vector<EvenError>& errors) {
  const BlockGrid& grid = data.grid;
  const Columns columns = design(data, effects);
  const Eigen::Index p = columns.cols() - 1 - grid.constants();
  Eigen::VectorXd all = Eigen::VectorXd::Zero(columns.rows());
  Eigen::VectorXd held_out = all;
  Eigen::VectorXd held_in = all;
  if (p > 0) {
    all = columns.rightCols(p) * coefficients.tail(p);
    std::tie(held_out, held_in) = held_out_effects(grid, shape, columns, effects, coefficients.tail(p));
  }
  for (std::size_t r = 0; r < errors.size(); ++r) {
    EvenError& error = errors[r];
    if (p == 0) {
      error.after = error.rest;
      error.held_out = error.rest_held_out;
      error.held_in = error.rest;
      continue;
    }
    Samples& after = error.after.anew(error.rest.size());
    Samples& without = error.held_out.anew(error.rest_held_out.size());
    Samples& within = error.held_in.anew(error.rest.size());
    const BlockRange& record = grid.records[r];
    const BetweenBlocks of_all(grid, record, all), of_others(grid, record, held_out),
        of_own(grid, record, held_in);
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double at =
          static_cast<double>(i) * grid.sample_s / grid.block_s - 0.5 + 0.5 * grid.fine_s / grid.block_s;
      after[i] = error.rest[i] - of_all(at);
      without[i] = error.rest_held_out[i] - of_others(at);
      within[i] = error.rest[i] - of_own(at);
    }
  }
}

namespace {

// Of a step's size, what the means before and after have to differ by, all of them and the halves farther
// from it.
constexpr double kLasting = 0.4;
constexpr double kLastingFar = 0.25;

}  // namespace

bool predicts_held_out(const BlockData& data, const Claimed& claimed) {
  Columns white = design(data, claimed.model);
  Whitening(data.grid, claimed.noise.shape).apply(white);
  const Eigen::Index last = white.cols() - 1;
  const Projection others(white.middleCols(1, last - 1));
  Eigen::VectorXd y = white.col(0);
  Eigen::VectorXd x = white.col(last);
  others.take_out_of(y);
  others.take_out_of(x);
  const std::vector<int> fold = folds_of(data.grid, kFolds);
  std::array<double, kFolds> xy{};
  std::array<double, kFolds> xx{};
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const auto f = static_cast<std::size_t>(fold[static_cast<std::size_t>(i)]);
    xy[f] += x[i] * y[i];
    xx[f] += x[i] * x[i];
  }
  const double all_xy = std::accumulate(xy.begin(), xy.end(), 0.0);
  const double all_xx = std::accumulate(xx.begin(), xx.end(), 0.0);
  double gain = 0.0;
  for (std::size_t f = 0; f < kFolds; ++f) {
    if (all_xx - xx[f] <= 0.0) continue;
    const double c = (all_xy - xy[f]) / (all_xx - xx[f]);
    gain += 2.0 * c * xy[f] - c * c * xx[f];
  }
  return gain > 0.0;
}

bool step_persists(const BlockData& data, const Claimed& claimed) {
  const BlockGrid& grid = data.grid;
  const Candidate& step = claimed.model.back();
  const Columns columns = design(data, claimed.model);
  const Eigen::VectorXd c = solve(grid, claimed.noise.shape, columns);
  const Eigen::Index last = columns.cols() - 1;
  // Other steps stay where they are: of two that cancel, neither is still there later.
  Eigen::VectorXd taken = c.head(last - 1);
  for (std::size_t i = 0; i + 1 < claimed.model.size(); ++i)
    if (claimed.model[i].form == Form::kStep) taken[column_of(grid, claimed.model, i) - 1] = 0.0;
  const BlockRange& record = grid.records[step.record];
  const std::size_t window = std::max<std::size_t>(8, record.size() / 20);
  std::array<std::vector<double>, 2> level;  // before and after, in the order of time
  for (std::size_t b = record.first; b < record.end; ++b) {
    const double away = std::abs(grid.time_s[b] - step.time_s) / grid.block_s;
    if (!grid.valid[b] || away < 3.0 || away > static_cast<double>(window)) continue;
    const auto row = static_cast<Eigen::Index>(b);
    level[grid.time_s[b] > step.time_s ? 1 : 0].push_back(columns(row, 0) -
                                                          columns.row(row).segment(1, last - 1).dot(taken));
  }
  if (level[0].size() < 8 || level[1].size() < 8) return false;
  std::reverse(level[0].begin(), level[0].end());
  const auto change = [&](bool far) {
    std::array<double, 2> mean{};
    for (std::size_t side = 0; side < 2; ++side) {
      const auto from = level[side].begin() + static_cast<std::ptrdiff_t>(far ? level[side].size() / 2 : 0);
      mean[side] =
          std::accumulate(from, level[side].end(), 0.0) / static_cast<double>(level[side].end() - from);
    }
    return (mean[1] - mean[0]) / c[last - 1];
  };
  return change(false) > kLasting && change(true) > kLastingFar;
}

}  // namespace ifog
