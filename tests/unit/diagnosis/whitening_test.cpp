// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/whitening.h"
#include "filters/diagnosis/channels/reconstruct.h"
#include "filters/diagnosis/record/step_means.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/report/prediction.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

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

// What a channel was behind its readings.

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(Reconstruct, ATemperatureReadInWholeDegreesIsKnownToATenth) {
  test::Noise noise(1, 0.01);
  std::vector<double> truth, read;
  for (int i = 0; i < 8000; ++i) {
    truth.push_back(30.0 + 11.3 * std::sin(2.0 * M_PI * i / 5000.0));
    read.push_back(std::round(truth.back() + noise()));
  }
  const Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  EXPECT_GT(rms_difference(read, truth), 0.25);
  EXPECT_LT(rms_difference(found.values, truth), 0.1);
}

// A gyro's own thermometer, at 10 Hz: noise makes it flip where it crosses, for seconds.
TEST(Reconstruct, AReadingThatFlipsBetweenTwoDegreesIsKnownToATenth) {
  test::Noise noise(2, 0.02);
  std::vector<double> truth, read;
  StepStarts starts;
  constexpr std::size_t kSamples = 144000, kStep = 3;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    const double kelvin = 50.0 - 25.0 * std::exp(-t / 3000.0) + 2.0 * std::sin(2.0 * M_PI * t / 2500.0);
    read.push_back(std::round(kelvin + noise()));
    if (i % kStep == 1) truth.push_back(kelvin);
    if (i % kStep == 0) starts.push_back(i);
  }
  starts.push_back(kSamples);
  const Reconstruction found = reconstruct(step_means(read, starts, false, false, is_coarse(read)).means);
  EXPECT_TRUE(found.smooth);
  EXPECT_LT(rms_difference(found.values, truth), 0.1);
}

// RMS error of what is made of a channel that is read with a noise of 0.01.
double left_of_noise(const std::vector<double>& truth, unsigned seed) {
  test::Noise noise(seed, 0.01);
  std::vector<double> read;
  for (const double each : truth) read.push_back(each + noise());
  const Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  return rms_difference(found.values, truth);
}

// Two kinks in hours of straight lines, and the spline has to turn there all the same.
TEST(Reconstruct, ARampBetweenSoaksKeepsItsKinks) {
  std::vector<double> truth{10.0};
  for (int i = 0; i < 22000; ++i) {
    const double target = 10.0 + 24.0 * std::clamp((i - 4000.0) / 13000.0, 0.0, 1.0);
    truth.push_back(truth.back() + (target - truth.back()) / 200.0);
  }
  EXPECT_LT(left_of_noise(truth, 5), 0.003);
}

// A spline through jumps or jitter would be another channel.
TEST(Reconstruct, WhatJumpsOrJittersStaysAsItWasRead) {
  test::Noise noise(3);
  std::vector<double> jumps, walk;
  double level = 0.0;
  double place = 0.0;
  for (int i = 0; i < 6000; ++i) {
    if (i % 200 == 0) level = 5.0 * noise();
    place += 0.05 * noise();
    jumps.push_back(level + 0.002 * noise());
    walk.push_back(place + 0.002 * noise());
  }
  for (const std::vector<double>& channel : {jumps, walk}) {
    const Reconstruction found = reconstruct(channel);
    EXPECT_FALSE(found.smooth);
    EXPECT_EQ(found.values, channel);
    EXPECT_FALSE(stands_still(channel));
  }
}

// The plug of a thermometer comes off while it warms: its last reading is all that is known from there on.
TEST(Reconstruct, AChannelThatIsLostIsNotExtrapolated) {
  std::vector<double> read(6000, std::nan(""));
  StepStarts starts;
  for (std::size_t i = 0; i <= read.size(); ++i) starts.push_back(i);
  for (std::size_t i = 0; i < 3000; i += 10) read[i] = 20.0 + 1e-6 * static_cast<double>(i * i);
  const StepMeans steps = step_means(read, starts, false, false);
  const Reconstruction found = reconstruct(steps.means, steps.read);
  EXPECT_TRUE(found.smooth);
  EXPECT_NEAR(found.values[1495], 20.0 + 1e-6 * 1495.0 * 1495.0, 0.01);
  EXPECT_NEAR(found.values[5999], read[2990], 0.3);
}

TEST(Reconstruct, ReadingNoiseAloneIsStandingStill) {
  test::Noise noise(4);
  int moving = 0;
  for (int channel = 0; channel < 50; ++channel) {
    std::vector<double> read;
    for (int i = 0; i < 5000; ++i) read.push_back(3.9 + 0.002 * noise());
    moving += stands_still(read) ? 0 : 1;
  }
  EXPECT_EQ(moving, 0);
}

}  // namespace
}  // namespace ifog
