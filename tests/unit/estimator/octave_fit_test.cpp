// SPDX-License-Identifier: Apache-2.0
// The fit by octaves on variances in closed form: of white noise, of a first-order autoregression, of
// quantisation, each with a walk beside it.
#include "filters/estimator/octave_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace {

constexpr std::size_t kOctaves = 14;
constexpr double kSamples = 1 << 18;

struct Octaves {
  std::vector<double> squares, counts;
};

// Of a noise with this autocovariance: second differences of three neighbouring means of m samples are sums
// with weights 1/m, -2/m, 1/m, whose own correlation at lag k is c(k).
Octaves octaves(const std::function<double(int)>& autocovariance, double walk) {
  Octaves out;
  for (std::size_t k = 0; k < kOctaves; ++k) {
    const int m = 1 << k;
    const auto weight = [m](int i) { return i < m || i >= 2 * m ? 1.0 / m : -2.0 / m; };
    double variance = walk * m;
    // Of lags longer than 200 samples none here has any covariance left.
    for (int lag = -std::min(3 * m - 1, 200); lag <= std::min(3 * m - 1, 200); ++lag) {
      double overlap = 0.0;
      for (int i = std::max(0, -lag); i < std::min(3 * m, 3 * m - lag); ++i)
        overlap += weight(i) * weight(i + lag);
      variance += overlap * autocovariance(std::abs(lag));
    }
    const double count = kSamples / (2.0 * m);
    out.squares.push_back(count * variance);
    out.counts.push_back(count);
  }
  return out;
}

double best_ratio(const Octaves& of, ifog::OctaveFit& fit) {
  double best = 0.0;
  for (double ratio = 1e-10; ratio < 10.0; ratio *= 1.05) {
    const ifog::OctaveFit here = ifog::fit_octaves(of.squares, of.counts, ratio);
    if (here.misfit >= fit.misfit) continue;
    fit = here;
    best = ratio;
  }
  return best;
}

TEST(OctaveFit, OfWhiteNoiseAndAWalkIsBoth) {
  for (const double walk : {1e-3, 1e-5}) {
    const Octaves of = octaves([](int lag) { return lag == 0 ? 2.0 : 0.0; }, walk);
    ifog::OctaveFit fit;
    EXPECT_NEAR(best_ratio(of, fit) * fit.low_noise / walk, 1.0, 0.05);
    EXPECT_NEAR(fit.low_noise, 2.0, 0.01);
    EXPECT_NEAR(fit.noise, 2.0, 0.01);
  }
}

// An octave is fitted that is off by less than it costs to leave it to itself: some per cent remain.
TEST(OctaveFit, ColourOfNeighboursIsNoWalk) {
  for (const double colour : {0.2, 0.5, 0.8, -0.4}) {
    const double walk = 1e-5;
    const Octaves of = octaves([colour](int lag) { return std::pow(colour, lag); }, walk);
    ifog::OctaveFit fit;
    EXPECT_NEAR(best_ratio(of, fit) * fit.low_noise / walk, 1.0, 0.3) << colour;
    EXPECT_NEAR(fit.low_noise * (1.0 - colour) / (1.0 + colour), 1.0, 0.1) << colour;
    EXPECT_NEAR(fit.noise, 1.0, 0.2) << colour;
  }
}

// The rate of a quantised angle: differences of white noise, beside white rate noise of a tenth of it. In the
// octave where they cross half of what is there is still quantisation.
TEST(OctaveFit, QuantisedAngleIsNoWalk) {
  const double walk = 1e-5;
  const Octaves of = octaves([](int lag) { return lag == 0 ? 2.1 : lag == 1 ? -1.0 : 0.0; }, walk);
  ifog::OctaveFit fit;
  EXPECT_NEAR(best_ratio(of, fit) * fit.low_noise / walk, 1.0, 0.3);
  EXPECT_GT(fit.low_noise, 0.1);
  EXPECT_LT(fit.low_noise, 0.15);
}

TEST(OctaveFit, OfNothingIsNothing) {
  const std::vector<double> none(kOctaves, 0.0);
  const ifog::OctaveFit fit = ifog::fit_octaves(none, none, 1e-3);
  EXPECT_EQ(fit.low_noise, 0.0);
  EXPECT_EQ(fit.noise, 0.0);
}

}  // namespace
