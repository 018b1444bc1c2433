#include "filters/diagnosis/regression/noise_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace ifog {
namespace {

// Below these a component changes the likelihood of a few thousand blocks by nothing: it is taken for zero.
constexpr double kLeastWalk = 1e-10;
constexpr double kLeastFlicker = 1e-6;
// Above this there is no white noise left to be relative to.
constexpr double kMost = 1e6;
// Twice the log-likelihood a Gauss-Markov process of its own has to gain for its two parameters.
constexpr double kMarkovGain = 14.0;

double evaluate(const BlockGrid& grid, const Columns& columns, const NoiseShape& shape) {
  return fit_whitened(grid, shape, columns).log_likelihood;
}

// One parameter at a time by a shrinking factor in both directions; the likelihood is smooth and nearly
// separable in the logarithms of walk and flicker, and zero is a value of its own that no factor reaches.
NoiseFit climb(const BlockGrid& grid, const Columns& columns, NoiseShape shape, bool with_markov,
               double precision) {
  double best = evaluate(grid, columns, shape);
  const auto attempt = [&](const NoiseShape& trial) {
    const double value = evaluate(grid, columns, trial);
    if (!(value > best + 1e-9)) return false;  // NaN is no way up
    best = value;
    shape = trial;
    return true;
  };
  std::vector<double NoiseShape::*> parameters = {&NoiseShape::walk, &NoiseShape::flicker};
  if (with_markov) {
    parameters.push_back(&NoiseShape::markov);
    parameters.push_back(&NoiseShape::markov_s);
  }
  double factor = 4.0;
  while (factor > precision) {
    bool moved = false;
    for (double NoiseShape::*parameter : parameters) {
      if (shape.*parameter == 0.0) continue;
      for (const double f : {factor, 1.0 / factor}) {
        NoiseShape trial = shape;
        trial.*parameter *= f;
        while (attempt(trial)) {
          moved = true;
          trial = shape;
          trial.*parameter *= f;
          const double least = parameter == &NoiseShape::walk ? kLeastWalk : kLeastFlicker;
          if (trial.*parameter < least || trial.*parameter > kMost) break;
        }
      }
    }
    if (!moved) factor = std::sqrt(factor);
  }
  for (double NoiseShape::*parameter : {&NoiseShape::walk, &NoiseShape::flicker}) {
    if (shape.*parameter == 0.0) continue;
    NoiseShape trial = shape;
    trial.*parameter = 0.0;
    const double value = evaluate(grid, columns, trial);
    if (value >= best - 0.02) {
      best = std::max(best, value);
      shape = trial;
    }
  }
  const WhitenedFit fit = fit_whitened(grid, shape, columns);
  return {shape, fit.log_likelihood, fit.white_variance};
}

}  // namespace

WhitenedFit fit_whitened(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns) {
  Columns white = columns;
  const Whitening filter(grid, shape);
  filter.apply(white);
  const Eigen::Index p = columns.cols() - 1;
  const Eigen::MatrixXd gram = white.transpose() * white;
  double square = gram(0, 0);
  if (p > 0) {
    const Eigen::VectorXd scale = gram.diagonal().tail(p).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd a = scale.asDiagonal() * gram.bottomRightCorner(p, p) * scale.asDiagonal();
    const Eigen::VectorXd b = scale.asDiagonal() * gram.col(0).tail(p);
    square -= b.dot(Eigen::LDLT<Eigen::MatrixXd>(a).solve(b));
  }
  const auto n = static_cast<double>(grid.used());
  square = std::max(square, 1e-12 * gram(0, 0) + 1e-300);
  WhitenedFit fit;
  fit.residual_square = square;
  fit.white_variance = square / std::max(1.0, n - static_cast<double>(p)) / filter.innovation_variance();
  // With the white variance concentrated out, the determinant of a steady filter cancels its innovations'
  // scale.
  fit.log_likelihood = -0.5 * n * std::log(square / n);
  return fit;
}

NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns, const NoiseShape& start, double precision) {
  if (grid.dwells) {
    const WhitenedFit fit = fit_whitened(grid, {}, columns);
    return {{}, fit.log_likelihood, fit.white_variance};
  }
  NoiseShape shape = start;
  if (shape.walk == 0.0) shape.walk = 1e-5;
  if (shape.flicker == 0.0) shape.flicker = 1e-3;
  return climb(grid, columns, shape, shape.markov > 0.0, precision);
}

NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns) {
  if (grid.dwells) return fit_noise(grid, columns, {});
  // Walk and flicker stand in for each other along a ridge with more than one top: one climb from the best of
  // each kind of start.
  struct Start {
    NoiseShape shape;
    double value = -1e300;
  };
  std::array<Start, 3> starts;  // mostly walk, mostly flicker, both
  for (const double walk : {0.0, 1e-6, 1e-4, 1e-2, 1.0}) {
    for (const double flicker : {0.0, 1e-3, 1e-1, 1e1}) {
      const NoiseShape shape{walk, flicker, 0.0, 0.0};
      const double value = evaluate(grid, columns, shape);
      Start& start = starts[flicker == 0.0 ? 0 : walk == 0.0 ? 1 : 2];
      if (value > start.value) start = {shape, value};
    }
  }
  NoiseFit best;
  best.log_likelihood = -1e300;
  for (const Start& start : starts) {
    const NoiseFit fit = fit_noise(grid, columns, start.shape);
    if (fit.log_likelihood > best.log_likelihood) best = fit;
  }

  NoiseFit richer = best;
  for (const double blocks : {1.0, 8.0, 64.0}) {
    for (const double variance : {0.3, 10.0}) {
      NoiseShape shape = best.shape;
      shape.markov_s = blocks * grid.block_s;
      shape.markov = variance;
      const double value = evaluate(grid, columns, shape);
      if (value > richer.log_likelihood) richer = {shape, value, 0.0};
    }
  }
  if (richer.shape.markov > 0.0) richer = climb(grid, columns, richer.shape, true, 1.05);
  return 2.0 * (richer.log_likelihood - best.log_likelihood) > kMarkovGain ? richer : best;
}

}  // namespace ifog
