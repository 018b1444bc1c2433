// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/noise_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "filters/diagnosis/regression/harmonics.h"
#include "filters/diagnosis/regression/noise_climb.h"
#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// Twice the log-likelihood a Gauss-Markov process of its own has to gain for its two parameters.
constexpr double kMarkovGain = 14.0;

double evaluate(const BlockGrid& grid, const Columns& columns, const NoiseShape& shape) {
  return fit_whitened(grid, shape, columns).log_likelihood;
}

}  // namespace

WhitenedFit fit_whitened(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns) {
  Columns white = columns;
  const Whitening filter(grid, shape);
  filter.apply(white);
  const Eigen::Index p = columns.cols() - 1;
  const Eigen::MatrixXd gram = white.transpose() * white;
  double square = gram(0, 0);
  if (p > 0) square -= NormalEquations::of_measured_first(gram).explained();
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
  return climb(grid, columns, shape, precision);
}

namespace {

// Walk and flicker stand in for each other along a ridge with more than one top: one climb from the best of
// each kind of start.
NoiseFit fit_walk_and_flicker(const BlockGrid& grid, const Columns& columns) {
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
  return best;
}

NoiseFit with_markov(const BlockGrid& grid, const Columns& columns, const NoiseFit& best) {
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
  if (richer.shape.markov > 0.0) richer = climb(grid, columns, richer.shape, 1.05);
  return 2.0 * (richer.log_likelihood - best.log_likelihood) > kMarkovGain ? richer : best;
}

}  // namespace

NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns) {
  if (grid.dwells) return fit_noise(grid, columns, {});
  // Resonances first: what a process of its own is taken for may be one.
  return with_markov(grid, columns, with_harmonics(grid, columns, fit_walk_and_flicker(grid, columns)));
}

}  // namespace ifog
