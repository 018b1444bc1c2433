// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/diagnosis/regression/design.h"
#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// Noise parameters are tried logarithmically from negligible (1 % of the white noise's part in the record's
// mean) to values that leave no white noise.
constexpr double kNegligible = 0.03;
constexpr double kMostRatio = 1e6;
constexpr double kCoarse = 6.0;    // ratio in the first grid
constexpr double kFarBelow = 8.0;  // log-likelihood; smaller values are ignored
constexpr int kFineGrid = 9;       // values per parameter in the second grid
// Prior standard deviation of the logarithm of a time constant: the search's range.
constexpr double kLogRange = 2.0;
constexpr double kLogStep = 0.05;

struct Solved {
  double log_likelihood = -1e300;  // restricted, with concentrated white variance
  double white_variance = 0.0;
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

// known: prior standard deviations of the last columns' values, infinite if unknown.
Solved solve_at(const BlockGrid& grid, const Columns& columns, const Eigen::VectorXd& known,
                const NoiseShape& shape, double white_guess) {
  Columns white = columns;
  const Whitening filter(grid, shape);
  filter.apply(white);
  const Eigen::Index p = columns.cols() - 1;
  Eigen::MatrixXd gram = white.transpose() * white;
  const double innovation = white_guess * filter.innovation_variance();
  for (Eigen::Index i = 0; i < p; ++i) {
    if (std::isfinite(known[i])) gram(1 + i, 1 + i) += innovation / (known[i] * known[i]);
  }
  const NormalEquations fit = NormalEquations::of_measured_first(gram);
  const auto n = static_cast<double>(grid.used());
  const double free = std::max(1.0, n - static_cast<double>(p));
  const double square = std::max(gram(0, 0) - fit.explained(), 1e-12 * gram(0, 0) + 1e-300);
  Solved solved;
  solved.values = fit.coefficients();
  solved.covariance = square / free * fit.inverse();
  solved.white_variance = square / free / filter.innovation_variance();
  solved.log_likelihood = -0.5 * free * std::log(square) - 0.5 * fit.log_determinant();
  return solved;
}

std::vector<double> logarithmic(double low, double high, int count) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  const double step = count > 1 ? std::log(high / low) / (count - 1) : 0.0;
  for (int i = 0; i < count; ++i) values.push_back(low * std::exp(step * i));
  return values;
}

struct Tried {
  NoiseShape shape;
  Solved solved;
};

template <class Evaluate>
std::vector<Tried> try_all(const NoiseShape& base, const std::vector<double>& walks,
                           const std::vector<double>& flickers, Evaluate&& evaluate) {
  std::vector<Tried> tried;
  for (const double walk : walks) {
    for (const double flicker : flickers) {
      NoiseShape shape = base;
      shape.walk = walk;
      shape.flicker = flicker;
      tried.push_back({shape, evaluate(shape)});
    }
  }
  return tried;
}

double best_of(const std::vector<Tried>& tried) {
  double best = -1e300;
  for (const Tried& each : tried) best = std::max(best, each.solved.log_likelihood);
  return best;
}

// Range of the relevant values of one parameter, plus one grid step on either side.
std::pair<double, double> span_of(const std::vector<Tried>& tried, double NoiseShape::*parameter, double step,
                                  const std::pair<double, double>& limits) {
  const double least = best_of(tried) - kFarBelow;
  double low = 1e300;
  double high = 0.0;
  for (const Tried& each : tried) {
    if (each.solved.log_likelihood < least) continue;
    low = std::min(low, each.shape.*parameter);
    high = std::max(high, each.shape.*parameter);
  }
  return {std::max(low / step, limits.first), std::min(high * step, limits.second)};
}

}  // namespace

Columns searched_columns(const BlockData& data, const std::vector<Candidate>& effects,
                         const Eigen::VectorXd& coefficients, Eigen::Index nuisances,
                         std::vector<std::size_t>* of) {
  std::vector<Eigen::VectorXd> found;
  Eigen::Index at = nuisances;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const Candidate& effect = effects[i];
    const double scale = coefficients[at++] / (2.0 * kLogStep);
    if (effect.is_transition()) {
      for (const bool middle : {false, true}) {
        Candidate less = effect;
        Candidate more = effect;
        (middle ? less.centre : less.half_width) -= kLogStep * effect.half_width;
        (middle ? more.centre : more.half_width) += kLogStep * effect.half_width;
        found.push_back(scale * (regressor(data, more) - regressor(data, less)));
      }
      if (of) of->push_back(i);
    } else if (effect.searched()) {
      Candidate less = effect;
      Candidate more = effect;
      less.time_constant_s *= std::exp(-kLogStep);
      more.time_constant_s *= std::exp(kLogStep);
      found.push_back(scale * (regressor(data, more) - regressor(data, less)));
    }
    if (of && effect.searched()) of->push_back(i);
  }
  Columns columns(static_cast<Eigen::Index>(data.grid.size()), static_cast<Eigen::Index>(found.size()));
  for (std::size_t j = 0; j < found.size(); ++j) columns.col(static_cast<Eigen::Index>(j)) = found[j];
  return columns;
}

namespace {

// Evaluates walks and flickers that the record allows: first a coarse grid, then finer ones, because a long
// record may leave one point of the coarse grid.
template <class Evaluate>
std::vector<Tried> try_noise(const BlockGrid& grid, const NoiseShape& best, Evaluate&& evaluate) {
  if (grid.dwells) return {Tried{best, evaluate(best)}};
  const auto n = static_cast<double>(grid.used());
  const std::pair<double, double> walks{kNegligible / (n * n), kMostRatio};
  const std::pair<double, double> flickers{kNegligible / n, kMostRatio};
  const auto coarse = [](const std::pair<double, double>& limits) {
    const int count =
        1 + static_cast<int>(std::ceil(std::log(limits.second / limits.first) / std::log(kCoarse)));
    return logarithmic(limits.first, limits.second, count);
  };
  std::vector<Tried> tried = try_all(best, coarse(walks), coarse(flickers), evaluate);
  for (const double factor : {kCoarse, 1.5}) {
    const auto walk = span_of(tried, &NoiseShape::walk, factor, walks);
    const auto flicker = span_of(tried, &NoiseShape::flicker, factor, flickers);
    tried = try_all(best, logarithmic(walk.first, walk.second, kFineGrid),
                    logarithmic(flicker.first, flicker.second, kFineGrid), evaluate);
  }
  return tried;
}

// Averages, weighted by the restricted likelihood.
void average(const BlockGrid& grid, const std::vector<Tried>& tried, JointFit& fit) {
  const double top = best_of(tried);
  double sum = 0.0;
  for (const Tried& each : tried) sum += std::exp(each.solved.log_likelihood - top);
  const Eigen::Index p = tried.front().solved.values.size();
  fit.values = Eigen::VectorXd::Zero(p);
  for (const Tried& each : tried) {
    const double weight = std::exp(each.solved.log_likelihood - top) / sum;
    const double white = each.solved.white_variance;
    fit.noise.parts.push_back(
        {weight, white * grid.block_s, each.shape.walk * white / grid.block_s, each.shape.flicker * white});
    fit.values += weight * each.solved.values;
  }
  for (const double blocks : flicker_bank(grid)) fit.noise.flicker_s.push_back(blocks * grid.block_s);
  fit.covariance = Eigen::MatrixXd::Zero(p, p);
  for (const Tried& each : tried) {
    const double weight = std::exp(each.solved.log_likelihood - top) / sum;
    const Eigen::VectorXd away = each.solved.values - fit.values;
    fit.covariance += weight * (each.solved.covariance + away * away.transpose());
  }
}

}  // namespace

JointFit joint_fit(const BlockData& data, const std::vector<Candidate>& effects, const NoiseFit& best,
                   const Eigen::VectorXd* coefficients) {
  const BlockGrid& grid = data.grid;
  JointFit fit;
  const Columns base = design(data, effects);
  Columns more(base.rows(), 0);
  if (coefficients) more = searched_columns(data, effects, *coefficients, grid.constants(), &fit.searched);
  Columns columns(base.rows(), base.cols() + more.cols());
  columns << base, more;
  Eigen::VectorXd known =
      Eigen::VectorXd::Constant(columns.cols() - 1, std::numeric_limits<double>::infinity());
  known.tail(more.cols()).setConstant(kLogRange);
  const auto evaluate = [&](const NoiseShape& shape) {
    return solve_at(grid, columns, known, shape, best.white_variance);
  };
  average(grid, try_noise(grid, best.shape, evaluate), fit);
  return fit;
}

}  // namespace ifog
