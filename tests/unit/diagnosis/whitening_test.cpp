// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/whitening.h"

#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/report/prediction.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

double gaussian(std::uint32_t counter, std::uint32_t stream) {
  return gaussian_deviate(counter, stream, 7, 11);
}

// What a block sees of a harmonic's covariance at a distance of `apart` blocks: itself, or its change.
double seen_covariance(const DampedHarmonic& harmonic, double apart) {
  const auto at = [&](double k) {
    return harmonic.variance * std::exp(-std::abs(k) / harmonic.decay) *
           std::cos(2.0 * M_PI * harmonic.cycles * k);
  };
  return harmonic.of == DampedHarmonic::Of::kRate ? at(apart)
                                                  : 2.0 * at(apart) - at(apart - 1.0) - at(apart + 1.0);
}

// The covariance as it is defined, whitened by its Cholesky factor: the second way to the same least squares.
TEST(Whitening, LeastSquaresOfInnovationsIsGeneralisedLeastSquares) {
  using Of = DampedHarmonic::Of;
  constexpr Eigen::Index n = 600;
  for (const NoiseShape& shape :
       {NoiseShape{0.02, 0.0}, NoiseShape{0.0, 0.0, {{50.0, 0.11, 12.0, Of::kAngle}}},
        NoiseShape{0.0, 0.0, {{50.0, 0.11, 12.0, Of::kRate}}}}) {
    Columns columns(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      columns(i, 0) = gaussian(static_cast<std::uint32_t>(i), 1) + 0.01 * static_cast<double>(i);
      columns(i, 1) = 1.0;
      columns(i, 2) = std::sin(0.05 * static_cast<double>(i));
    }
    Eigen::MatrixXd covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        // A walk that starts anywhere: a large variance of its start stands for the diffuse one.
        covariance(i, j) = 1e4 + shape.walk * static_cast<double>(std::min(i, j)) + (i == j ? 1.0 : 0.0);
        for (const DampedHarmonic& each : shape.harmonics)
          covariance(i, j) += seen_covariance(each, static_cast<double>(i - j));
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    const Eigen::MatrixXd x = columns.rightCols(2);
    const Eigen::VectorXd expected =
        (x.transpose() * factor.solve(x))
            .ldlt()
            .solve(x.transpose() * factor.solve(Eigen::VectorXd(columns.col(0))));

    const BlockGrid grid = grid_of({n});
    Columns white = columns;
    Whitening(grid, shape).apply(white);
    const Eigen::VectorXd found =
        Eigen::MatrixXd(white.rightCols(2)).colPivHouseholderQr().solve(Eigen::VectorXd(white.col(0)));
    // A steady filter weighs the first blocks, which hold a harmonic's start, otherwise.
    const double tolerance = shape.harmonics.empty() ? 1e-3 : 0.03;
    EXPECT_NEAR(found[1], expected[1], tolerance * std::abs(expected[1])) << shape.harmonics.size();
  }
}

TEST(NoiseFit, FindsTheWalkItWasGiven) {
  constexpr std::size_t n = 4000;
  const BlockGrid grid = grid_of({n});
  Columns columns(n, 2);
  double walk = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) {
    walk += 0.03 * gaussian(i, 2);
    columns(i, 0) = 2.0 * (gaussian(i, 3) + walk);
    columns(i, 1) = 1.0;
  }
  const NoiseFit fit = fit_noise(grid, columns);
  const NoiseTerms terms = noise_terms(fit.shape, fit.white_variance, grid.block_s);
  EXPECT_NEAR(*terms.N, 2.0, 0.15);
  ASSERT_TRUE(terms.K.has_value());
  EXPECT_NEAR(*terms.K, 0.06, 0.02);
}

// A search that climbs "while it is no worse" never ends where every comparison is false.
TEST(NoiseFit, ComesToAnEndWhereTheLikelihoodIsNoNumber) {
  constexpr std::size_t n = 200;
  const BlockGrid grid = grid_of({n});
  for (const double bad : {std::nan(""), HUGE_VAL, 1e200}) {
    Columns columns(n, 2);
    for (std::uint32_t i = 0; i < n; ++i) {
      columns(i, 0) = gaussian(i, 4);
      columns(i, 1) = 1.0;
    }
    columns(n / 2, 0) = bad;
    for (const NoiseFit& fit : {fit_noise(grid, columns), fit_noise(grid, columns, NoiseShape{1e-3, 1e-2})}) {
      for (const double value : {fit.shape.walk, fit.shape.flicker})
        EXPECT_TRUE(value >= 0.0 && value <= 1e9) << value << " with " << bad;
      if (!std::isfinite(bad)) {
        EXPECT_FALSE(fit.log_likelihood > -1e300) << bad;  // none is claimed
      }
    }
  }
}

// Integral of white noise less its mean over the alignment: N^2 (T + T^2/A); of a walk held from the end of
// the alignment onwards K^2 (T^3/3 + T^2 A/3).
TEST(Prediction, IsTheClosedFormOfWhiteNoiseAndWalk) {
  const double aligned = 200.0;
  const double horizon = 3600.0;
  NoisePosterior white;
  white.parts = {{.weight = 1.0, .white = 4.0}};
  const double angle = std::sqrt(heading_variance(white, aligned, horizon));
  EXPECT_NEAR(angle, 2.0 * std::sqrt(horizon + horizon * horizon / aligned), 1e-6);
  NoisePosterior walk;
  walk.parts = {{.weight = 0.5, .walk = 0.5}, {.weight = 0.5, .walk = 1.5}};
  const double expected = std::sqrt(horizon * horizon * horizon / 3.0 + horizon * horizon * aligned / 3.0);
  EXPECT_NEAR(std::sqrt(heading_variance(walk, aligned, horizon)), expected, 2e-3 * expected);
}

}  // namespace
}  // namespace ifog
