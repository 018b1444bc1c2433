// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/noise_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace ifog {

WhitenedFit fit_whitened(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns,
                         const Prior& prior) {
  Columns white = columns;
  const Whitening filter(grid, shape);
  filter.apply(white);
  Eigen::MatrixXd gram = white.transpose() * white;
  gram.diagonal().tail(prior.coefficients).array() += prior.weight * filter.innovation_variance();
  const NormalEquations equations = NormalEquations::of_measured_first(gram);
  const double square = std::max(gram(0, 0) - equations.explained(), 1e-12 * gram(0, 0) + 1e-300);
  const auto n = static_cast<double>(grid.used());
  return {equations, square, n, std::max(1.0, n - static_cast<double>(columns.cols() - 1)),
          filter.innovation_variance()};
}

namespace {

NoiseFit noise_fit_at(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns) {
  const WhitenedFit fit = fit_whitened(grid, shape, columns);
  return {shape, fit.log_likelihood(), fit.white_variance()};
}

}  // namespace

NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns, const NoiseShape& start, double precision) {
  if (grid.dwells) return noise_fit_at(grid, {}, columns);
  NoiseShape shape = start;
  if (shape.walk == 0.0) shape.walk = 1e-5;
  if (shape.flicker == 0.0) shape.flicker = 1e-3;
  return climb(grid, columns, shape, precision);
}

namespace {

// Walk and flicker partly replace each other, so there may be several maxima: one search from the best of
// each kind of start.
NoiseFit fit_walk_and_flicker(const BlockGrid& grid, const Columns& columns) {
  struct Start {
    NoiseShape shape;
    double value = -1e300;
  };
  std::array<Start, 3> starts;  // walk, flicker, both
  for (const double walk : {0.0, 1e-6, 1e-4, 1e-2, 1.0}) {
    for (const double flicker : {0.0, 1e-3, 1e-1, 1e1}) {
      const NoiseShape shape{walk, flicker};
      const double value = fit_whitened(grid, shape, columns).log_likelihood();
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

}  // namespace

NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns) {
  if (grid.dwells) return fit_noise(grid, columns, {});
  return with_harmonics(grid, columns, fit_walk_and_flicker(grid, columns));
}

namespace {

// Smaller components do not change the likelihood of a few thousand blocks and are set to zero.
constexpr double kLeastWalk = 1e-10;
constexpr double kLeastFlicker = 1e-6;
// Above this the white noise is negligible.
constexpr double kMostNoise = 1e6;

// Multiplies one parameter by a factor; false if not possible.
using Way = std::function<bool(NoiseShape&, double)>;

Way way_of(double NoiseShape::*parameter) {
  const double least = parameter == &NoiseShape::walk ? kLeastWalk : kLeastFlicker;
  return [=](NoiseShape& shape, double factor) {
    shape.*parameter *= factor;
    return shape.*parameter >= least && (factor < 1.0 || shape.*parameter <= kMostNoise);
  };
}

void add_ways(const BlockGrid& grid, std::size_t harmonic, std::vector<Way>& ways) {
  const HarmonicLimits limits = harmonic_limits(grid);
  ways.emplace_back([=](NoiseShape& shape, double factor) {
    shape.harmonics[harmonic].variance *= factor;
    return factor < 1.0 || shape.harmonics[harmonic].seen_variance() <= kMostNoise;
  });
  ways.emplace_back([=](NoiseShape& shape, double factor) {
    double& decay = shape.harmonics[harmonic].decay;
    decay *= factor;
    return decay >= limits.least_decay && decay <= limits.most_decay;
  });
  // By the bandwidth.
  ways.emplace_back([=](NoiseShape& shape, double factor) {
    DampedHarmonic& each = shape.harmonics[harmonic];
    each.cycles += std::log(factor) / (2.0 * std::numbers::pi * each.decay);
    return each.cycles >= limits.least_cycles && each.cycles <= 0.5;
  });
}

// All other components together, in case the white noise was overestimated.
bool against_white(NoiseShape& shape, double factor) {
  shape.walk *= factor;
  shape.flicker *= factor;
  for (DampedHarmonic& each : shape.harmonics) each.variance *= factor;
  return factor < 1.0 || (shape.walk <= kMostNoise && shape.flicker <= kMostNoise &&
                          std::ranges::all_of(shape.harmonics, [](const DampedHarmonic& each) {
                            return each.seen_variance() <= kMostNoise;
                          }));
}

std::vector<Way> ways_of(const BlockGrid& grid, const NoiseShape& shape, bool with_harmonics) {
  std::vector<Way> ways;
  for (double NoiseShape::*parameter : {&NoiseShape::walk, &NoiseShape::flicker})
    if (shape.*parameter != 0.0) ways.push_back(way_of(parameter));
  if (!with_harmonics) return ways;
  ways.emplace_back(against_white);
  for (std::size_t i = 0; i < shape.harmonics.size(); ++i) add_ways(grid, i, ways);
  return ways;
}

}  // namespace

// Coordinate search in both directions with a shrinking factor. The likelihood is smooth and nearly separable
// in the logarithms; zero is tried separately.
NoiseFit climb(const BlockGrid& grid, const Columns& columns, NoiseShape shape, double precision,
               bool with_harmonics) {
  const auto evaluate = [&](const NoiseShape& at) {
    return fit_whitened(grid, at, columns).log_likelihood();
  };
  double best = evaluate(shape);
  const std::vector<Way> ways = ways_of(grid, shape, with_harmonics);
  double factor = 4.0;
  while (factor > precision) {
    bool moved = false;
    for (const Way& way : ways) {
      for (const double f : {factor, 1.0 / factor}) {
        for (NoiseShape trial = shape; way(trial, f); trial = shape) {
          const double value = evaluate(trial);
          if (!(value > best + 1e-9)) break;  // also ends at NaN
          best = value;
          shape = trial;
          moved = true;
        }
      }
    }
    if (!moved) factor = std::sqrt(factor);
  }
  for (double NoiseShape::*parameter : {&NoiseShape::walk, &NoiseShape::flicker}) {
    if (shape.*parameter == 0.0) continue;
    NoiseShape trial = shape;
    trial.*parameter = 0.0;
    const double value = evaluate(trial);
    if (value >= best - 0.02) {
      best = std::max(best, value);
      shape = trial;
    }
  }
  return noise_fit_at(grid, shape, columns);
}

}  // namespace ifog
