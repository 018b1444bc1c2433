// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/noise_climb.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "filters/diagnosis/regression/harmonics.h"

namespace ifog {
namespace {

// Below these a component changes the likelihood of a few thousand blocks by nothing: it is taken for zero.
constexpr double kLeastWalk = 1e-10;
constexpr double kLeastFlicker = 1e-6;
// Of what a harmonic swings, that does not return: below, it is an angle.
constexpr double kLeastStays = 1e-3;
// Above this there is no white noise left to be relative to.
constexpr double kMost = 1e6;

// One parameter a factor further; false where that leads nowhere.
using Way = std::function<bool(NoiseShape&, double)>;

Way way_of(double NoiseShape::*parameter) {
  const double least = parameter == &NoiseShape::walk ? kLeastWalk : kLeastFlicker;
  return [=](NoiseShape& shape, double factor) {
    shape.*parameter *= factor;
    return shape.*parameter >= least && (factor < 1.0 || shape.*parameter <= kMost);
  };
}

void add_ways(const BlockGrid& grid, const NoiseShape& start, std::size_t harmonic, std::vector<Way>& ways) {
  const HarmonicLimits limits = harmonic_limits(grid);
  ways.emplace_back([=](NoiseShape& shape, double factor) {
    shape.harmonics[harmonic].variance *= factor;
    return factor < 1.0 || shape.harmonics[harmonic].seen_variance() <= kMost;
  });
  ways.emplace_back([=](NoiseShape& shape, double factor) {
    double& decay = shape.harmonics[harmonic].decay;
    decay *= factor;
    return decay >= limits.least_decay && decay <= limits.most_decay;
  });
  // By its width.
  ways.emplace_back([=](NoiseShape& shape, double factor) {
    DampedHarmonic& each = shape.harmonics[harmonic];
    each.cycles += std::log(factor) / (2.0 * std::numbers::pi * each.decay);
    return each.cycles >= limits.least_cycles && each.cycles <= 0.5;
  });
  if (start.harmonics[harmonic].is_angle()) return;
  ways.emplace_back([=](NoiseShape& at, double factor) {
    DampedHarmonic& each = at.harmonics[harmonic];
    const double stays = (1.0 - each.returned) * factor;
    if (stays < kLeastStays || stays > 2.0) return false;
    each.return_instead(1.0 - stays);
    return true;
  });
}

// White noise that was taken for more than it is makes all else too small together.
bool against_white(NoiseShape& shape, double factor) {
  shape.walk *= factor;
  shape.flicker *= factor;
  shape.markov *= factor;
  for (DampedHarmonic& each : shape.harmonics) each.variance *= factor;
  return factor < 1.0 ||
         (shape.walk <= kMost && shape.flicker <= kMost &&
          std::all_of(shape.harmonics.begin(), shape.harmonics.end(),
                      [](const DampedHarmonic& each) { return each.seen_variance() <= kMost; }));
}

std::vector<Way> ways_of(const BlockGrid& grid, const NoiseShape& shape, bool with_harmonics) {
  std::vector<Way> ways;
  std::vector<double NoiseShape::*> parameters = {&NoiseShape::walk, &NoiseShape::flicker};
  if (shape.markov > 0.0) {
    parameters.push_back(&NoiseShape::markov);
    parameters.push_back(&NoiseShape::markov_s);
  }
  for (double NoiseShape::*parameter : parameters)
    if (shape.*parameter != 0.0) ways.push_back(way_of(parameter));
  if (!with_harmonics) return ways;
  ways.emplace_back(against_white);
  for (std::size_t i = 0; i < shape.harmonics.size(); ++i) add_ways(grid, shape, i, ways);
  return ways;
}

}  // namespace

// One parameter at a time by a shrinking factor in both directions; the likelihood is smooth and nearly
// separable in the logarithms of walk and flicker, and zero is a value of its own that no factor reaches.
NoiseFit climb(const BlockGrid& grid, const Columns& columns, NoiseShape shape, double precision,
               bool with_harmonics) {
  const auto evaluate = [&](const NoiseShape& at) { return fit_whitened(grid, at, columns).log_likelihood; };
  double best = evaluate(shape);
  const std::vector<Way> ways = ways_of(grid, shape, with_harmonics);
  double factor = 4.0;
  while (factor > precision) {
    bool moved = false;
    for (const Way& way : ways) {
      for (const double f : {factor, 1.0 / factor}) {
        for (NoiseShape trial = shape; way(trial, f); trial = shape) {
          const double value = evaluate(trial);
          if (!(value > best + 1e-9)) break;  // NaN is no way up
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
  const WhitenedFit fit = fit_whitened(grid, shape, columns);
  return {shape, fit.log_likelihood, fit.white_variance};
}

}  // namespace ifog
