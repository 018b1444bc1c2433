// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/cross_validation.h"

#include <algorithm>
#include <cmath>
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

// Between the middles of a record's blocks, for what is linear there.
struct Place {
  Eigen::Index low, high;
  double share;

  // at: counted in blocks from the first of them.
  Place(const BlockRange& record, double at) {
    const auto first = static_cast<double>(record.first);
    const auto last = static_cast<double>(record.end - 1);
    const double place = std::clamp(first + at, first, last);
    low = static_cast<Eigen::Index>(place);
    high = std::min(low + 1, static_cast<Eigen::Index>(last));
    share = place - static_cast<double>(low);
  }
  [[nodiscard]] double of(const Eigen::VectorXd& values) const {
    return values[low] + share * (values[high] - values[low]);
  }
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
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double at =
          static_cast<double>(i) * grid.sample_s / grid.block_s - 0.5 + 0.5 * grid.fine_s / grid.block_s;
      const Place place(grid.records[r], at);
      after[i] = error.rest[i] - place.of(all);
      without[i] = error.rest_held_out[i] - place.of(held_out);
      within[i] = error.rest[i] - place.of(held_in);
    }
  }
}

}  // namespace ifog
