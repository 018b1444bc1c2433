// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/noise_climb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

// Unit white noise on a walk whose step has this variance, and a constant as the only regressor.
struct Walking {
  BlockGrid grid;
  Columns columns;

  Walking(std::size_t blocks, double step_variance, std::uint64_t seed) : grid(grid_of({blocks})) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    double level = 0.0;
    for (Eigen::Index i = 0; i < grid.error.size(); ++i) {
      level += std::sqrt(step_variance) * normal(random);
      grid.error[i] = level + normal(random);
    }
    columns.resize(grid.error.size(), 2);
    columns << grid.error, Eigen::VectorXd::Ones(grid.error.size());
  }
};

// No walk tried beside the top is likelier, wherever the climb began; and the top is where the truth is,
// within four times what the curvature there leaves uncertain.
TEST(NoiseClimb, EndsAtTheTopBesideItsStart) {
  const double truth = 0.01;
  const Walking walking(4000, truth, 21);
  const auto at = [&](double log_walk) {
    NoiseShape shape;
    shape.walk = std::exp(log_walk);
    return fit_whitened(walking.grid, shape, walking.columns).log_likelihood;
  };
  for (const double start : {0.001, 0.1}) {
    NoiseShape shape;
    shape.walk = start;
    const NoiseFit top = climb(walking.grid, walking.columns, shape, 1.01);
    ASSERT_GT(top.shape.walk, 0.0);
    EXPECT_EQ(top.shape.flicker, 0.0);
    const double log_walk = std::log(top.shape.walk);
    for (const double step : {-1.0, -0.1, 0.1, 1.0})
      EXPECT_LT(at(log_walk + step), top.log_likelihood) << start;
    constexpr double kStep = 0.3;
    const double curvature =
        (2.0 * top.log_likelihood - at(log_walk + kStep) - at(log_walk - kStep)) / (kStep * kStep);
    EXPECT_NEAR(log_walk, std::log(truth), 4.0 / std::sqrt(curvature));
    EXPECT_NEAR(top.white_variance, 1.0, 0.1);
  }
}

// What was too large to be relative to white noise comes down again: of a record of unit white noise under a
// resonance the climb finds both, wherever it began.
TEST(NoiseClimb, ComesDownFromWhereNoWhiteNoiseIsLeft) {
  Walking still(2000, 0.0, 22);
  std::mt19937_64 random(23);
  std::normal_distribution<double> normal;
  const double left = std::exp(-1.0 / 40.0), turn = 2.0 * M_PI * 0.2, driven = std::sqrt(1.0 - left * left);
  double angle = 0.0, beside = 0.0;
  for (Eigen::Index i = 0; i < still.grid.error.size(); ++i) {
    const double before = angle;
    angle = left * (std::cos(turn) * before - std::sin(turn) * beside) + driven * 30.0 * normal(random);
    beside = left * (std::sin(turn) * before + std::cos(turn) * beside) + driven * 30.0 * normal(random);
    still.columns(i, 0) += angle - before;
  }
  const auto ended = [&](double too_large) {
    NoiseShape start;
    start.flicker = 1e-3 * too_large;
    start.harmonics = {{900.0 * too_large, 0.2, 40.0}};
    return climb(still.grid, still.columns, start, 1.05, true);
  };
  const NoiseFit near = ended(1.0), far = ended(1e10);
  EXPECT_NEAR(near.white_variance, 1.0, 0.3);
  EXPECT_NEAR(far.white_variance, 1.0, 0.3);
  EXPECT_NEAR(far.log_likelihood, near.log_likelihood, 1.0);
}

}  // namespace
}  // namespace ifog
