// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "filters/linear/least_squares.h"
#include "filters/linear/projection.h"
#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

constexpr double kCertainlyOff = 4.0;  // standard errors
constexpr double kVisible = 5.0;       // standard deviations of the prediction
constexpr double kUncertain = 0.2;     // largest uncertainty relative to the square of the prediction
constexpr double kMoves = 1e-6;        // smallest square of the regressors in the others, relative to here
constexpr double kAsMuch = 0.25;       // smallest square of the regressors here, relative to all others
constexpr double kUnseen = 9.0;        // twice the log-likelihood gained by the common law

// The error and the group's columns in the other records and in this one, whitened and with all other effects
// projected out.
struct Whitened {
  Eigen::VectorXd error;
  Eigen::MatrixXd others, here;
  double variance = 0.0;  // of an innovation
};

Whitened whitened(const BlockData& data, const std::vector<Candidate>& effects,
                  const std::vector<std::size_t>& group, std::size_t record, const NoiseFit& noise) {
  const BlockRange& here = data.grid.records[record];
  const Columns joint = design(data, effects);
  const auto g = static_cast<Eigen::Index>(group.size());
  Columns columns = Columns::Zero(joint.rows(), joint.cols() + g);
  Eigen::Index other = 0, mine = joint.cols() - g;
  for (Eigen::Index j = 0; j < joint.cols(); ++j) {
    if (std::ranges::none_of(group, [&](std::size_t i) { return column_of(data.grid, i) == j; })) {
      columns.col(other++) = joint.col(j);
      continue;
    }
    columns.col(mine) = joint.col(j);
    columns.col(mine).segment(here.row(), here.rows()).setZero();
    columns.col(mine++ + g).segment(here.row(), here.rows()) = joint.col(j).segment(here.row(), here.rows());
  }
  // Noise that was fitted with common coefficients has absorbed the differences between captures.
  Columns white = columns;
  Whitening(data.grid, fit_noise(data.grid, columns, noise.shape).shape).apply(white);
  const Eigen::Index p = white.cols() - 1;
  Columns kept(white.rows(), 1 + 2 * g);
  kept << white.col(0), white.rightCols(2 * g);
  Projection(white.middleCols(1, p - 2 * g)).take_out_of(kept);
  const double left = left_by(Columns(kept.rightCols(2 * g)), kept.col(0)).squaredNorm();
  return {kept.col(0), kept.middleCols(1, g), kept.rightCols(g),
          left / std::max(1.0, static_cast<double>(data.grid.used()) - static_cast<double>(p))};
}

// Compares the prediction by the other records' coefficients with this record.
bool prediction_fails(const Whitened& of, DeniedEffects& found) {
  if (of.others.squaredNorm() < kMoves * of.here.squaredNorm()) return false;
  const LeastSquares by_others(of.others);
  if (by_others.rank() < of.others.cols()) return false;
  const Eigen::VectorXd c = by_others.coefficients(of.error);
  const Eigen::MatrixXd covariance =
      of.variance * SymmetricSolver(of.others.transpose() * of.others).inverse();
  const Eigen::VectorXd predicted = of.here * c;
  const double square = predicted.squaredNorm();
  const double doubt = ((of.here.transpose() * of.here) * covariance).trace();
  if (square < kVisible * kVisible * of.variance || doubt > kUncertain * square) return false;
  found.share = predicted.dot(of.error) / square;
  const Eigen::VectorXd slope = of.here.transpose() * (of.error - 2.0 * found.share * predicted) / square;
  found.share_error = std::sqrt(of.variance / square + slope.dot(covariance * slope));
  return found.share + kCertainlyOff * found.share_error < 0.5;
}

// True if the others show the effect and this record does not although its regressors vary as much.
bool unseen_though_moved(const Whitened& of, DeniedEffects& found) {
  for (Eigen::Index k = 0; k < of.here.cols(); ++k)
    if (of.here.col(k).squaredNorm() < kAsMuch * of.others.col(k).squaredNorm()) return false;
  const Eigen::MatrixXd all = of.others + of.here;
  const Eigen::VectorXd c = LeastSquares(all).coefficients(of.error);
  const auto gain = [&](const Eigen::MatrixXd& columns) {
    const Eigen::VectorXd taken = columns * c;
    return taken.dot(2.0 * of.error - taken) / of.variance;
  };
  if (gain(of.others) < kVisible * kVisible || gain(of.here) > kUnseen) return false;
  found.share = std::numeric_limits<double>::quiet_NaN();
  return true;
}

// Effects connected to effect `at` by shared channels, directly or indirectly.
std::vector<std::size_t> one_law(const std::vector<Candidate>& effects, std::size_t at) {
  const auto of_a_channel = [](const Candidate& each) {
    return each.channel != Candidate::kNone && each.first_reading == FirstReading::kError;
  };
  std::vector<std::size_t> group;
  if (!of_a_channel(effects[at])) return group;
  std::set<std::size_t> channels;
  for (std::size_t before = 0; channels.size() != before || before == 0;) {
    before = channels.size();
    group.clear();
    for (std::size_t i = 0; i < effects.size(); ++i) {
      const Candidate& each = effects[i];
      const bool shares = channels.contains(each.channel) || channels.contains(each.with_channel);
      if (i != at && !(of_a_channel(each) && shares)) continue;
      group.push_back(i);
      channels.insert(each.channel);
      if (each.with_channel != Candidate::kNone) channels.insert(each.with_channel);
    }
  }
  return group;
}

}  // namespace

std::optional<DeniedEffects> denied_by_a_capture(const BlockData& data, const std::vector<Candidate>& effects,
                                                 const NoiseFit& noise) {
  const std::size_t records = data.grid.records.size();
  if (records < 2) return std::nullopt;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const std::vector<std::size_t> group = one_law(effects, i);
    if (group.empty() || group.front() != i) continue;
    for (std::size_t r = 0; r < records; ++r) {
      const Whitened of = whitened(data, effects, group, r, noise);
      DeniedEffects found{group, r, 0.0, 0.0};
      if (prediction_fails(of, found) || unseen_though_moved(of, found)) return found;
    }
  }
  return std::nullopt;
}

}  // namespace ifog
