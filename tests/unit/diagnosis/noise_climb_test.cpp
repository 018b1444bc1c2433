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

}  // namespace
}  // namespace ifog
