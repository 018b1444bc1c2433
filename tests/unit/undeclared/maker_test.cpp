// SPDX-License-Identifier: Apache-2.0
// The maker's noise against the closed form of its spectrum and dense linear algebra.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "tests/bench/undeclared/noise.h"

namespace {

using namespace ifog::undeclared;

double density_of_flicker(const NoiseTruth& truth, double f_hz) {
  return truth.B * truth.B / (2.0 * std::numbers::pi * f_hz);
}

// One-sided density at f by averaging |DFT|^2 over many draws.
TEST(UndeclaredNoise, FlickerHasTheDensityOfIeee952) {
  const NoiseTruth truth{0.0, 1.0, 0.0};
  const std::size_t n = 2048;
  const NoiseModel model({1e-6, 1.0, 0.0}, n, 1.0);
  Draw draw(7, 0);
  const int records = 400;
  for (const std::size_t line : {8U, 16U, 32U}) {
    Draw same = draw;
    double power = 0.0;
    for (int r = 0; r < records; ++r) {
      const std::vector<double> x = model.draw(same);
      double re = 0.0, im = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        const double turn = 2.0 * std::numbers::pi * static_cast<double>(line * k) / static_cast<double>(n);
        const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / n);
        re += window * x[k] * std::cos(turn);
        im += window * x[k] * std::sin(turn);
      }
      power += (re * re + im * im) * 2.0 / (0.375 * static_cast<double>(n)) / records;
    }
    const double expected = density_of_flicker(truth, static_cast<double>(line) / static_cast<double>(n));
    EXPECT_NEAR(power / expected, 1.0, 4.0 / std::sqrt(records)) << "line " << line;
  }
}

// GLS by the dense covariance of white noise and a random walk: V = w^2 I + q^2 min(i, j).
TEST(UndeclaredNoise, VisibilityIsThatOfDenseLeastSquares) {
  const Eigen::Index n = 300;
  const double dt = 0.5, N = 2.0, K = 0.3;
  Eigen::MatrixXd V(n, n);
  Eigen::MatrixXd A(n, 3);
  Visibility::Column linear(1), wave(1);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      V(i, j) = K * K * dt * static_cast<double>(std::min(i, j)) + (i == j ? N * N / dt : 0.0);
    const double x = static_cast<double>(i) / static_cast<double>(n);
    A(i, 0) = x * x;
    A(i, 1) = std::sin(9.0 * x);
    A(i, 2) = 1.0;
    linear[0].push_back(A(i, 0));
    wave[0].push_back(A(i, 1));
  }
  const Eigen::MatrixXd covariance = (A.transpose() * V.ldlt().solve(A)).inverse();
  const auto model =
      std::make_shared<const NoiseModel>(NoiseTruth{N, 0.0, K}, static_cast<std::size_t>(n), dt);
  const Visibility oracle(model, 1);
  EXPECT_NEAR(oracle.of(linear, {wave}) * std::sqrt(covariance(0, 0)), 1.0, 1e-6);
  EXPECT_NEAR(oracle.of(wave, {linear}) * std::sqrt(covariance(1, 1)), 1.0, 1e-6);
}

}  // namespace
