// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/proof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "filters/linear/projection.h"

namespace ifog {
namespace {

constexpr double kGradual = 4.0;  // twice the log-likelihood
// Of a step's size, what the means before and after have to differ by, all of them and the halves farther
// from it.
constexpr double kLasting = 0.4;
constexpr double kLastingFar = 0.25;

// Whether a change spread over some time around the step explains more than the step itself.
bool gradual(const BlockData& data, const Claimed& claimed) {
  const BlockGrid& grid = data.grid;
  const Candidate& step = claimed.model.back();
  Columns columns = design(data, claimed.model);
  const double sudden = fit_whitened(grid, claimed.noise.shape, columns).log_likelihood;
  const BlockRange& record = grid.records[step.record];
  for (const double share : {0.005, 0.02, 0.06}) {
    const double width_s = std::max(4.0, share * static_cast<double>(record.size())) * grid.block_s;
    for (std::size_t b = record.first; b < record.end; ++b) {
      columns(static_cast<Eigen::Index>(b), columns.cols() - 1) =
          std::clamp(0.5 + (grid.time_s[b] - step.time_s) / width_s, 0.0, 1.0);
    }
    const double spread = fit_whitened(grid, claimed.noise.shape, columns).log_likelihood;
    if (2.0 * (spread - sudden) > kGradual) return true;
  }
  return false;
}

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
  constexpr int kFolds = 4;
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
  if (gradual(data, claimed)) return false;
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
