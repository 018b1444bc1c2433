// Noise of any colour is known by its Allan variance; no motion is taken for it.
#include "filters/estimator/noise_or_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace {

using ifog::NoiseOrMotion;

// How many of the windows, after the first, end with the verdict noise; rates about an offset that is a
// million times the noise.
int called_noise(NoiseOrMotion& judge, int windows, const std::function<double(int)>& rate,
                 const std::function<double(int)>& innovation) {
  int noise = 0;
  for (int w = 0; w < windows; ++w) {
    for (int i = w * NoiseOrMotion::kWindow; i < (w + 1) * NoiseOrMotion::kWindow; ++i)
      judge.take(0, 1e6 + rate(i), innovation(i));
    noise += w > 0 && judge.noise(0) ? 1 : 0;
  }
  return noise;
}

class Correlated : public testing::TestWithParam<double> {};

TEST_P(Correlated, IsNoiseOfItsVariance) {
  const double phi = GetParam();
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double x = normal(random), before = x;
  const auto next = [&](int) {
    before = x;
    return x = phi * x + std::sqrt(1 - phi * phi) * normal(random);
  };
  NoiseOrMotion judge;
  // What the last sample predicts is about as good as a tracker.
  EXPECT_GE(called_noise(judge, 11, next, [&](int) { return x - before; }), 7);
  if (!judge.noise(0)) return;
  // The closed forms for an autoregressive process of first order; the smaller of two windows is given.
  const double long_sum =
      (1 + phi) / (1 - phi) - 2 * phi * (1 - std::pow(phi, 64)) / (64 * std::pow(1 - phi, 2));
  EXPECT_NEAR(judge.variance(0), 1.0, 0.3);
  EXPECT_NEAR(judge.widening(0) / long_sum, 0.85, 0.4);
}

INSTANTIATE_TEST_SUITE_P(Neighbours, Correlated, testing::Values(0.0, 0.5, 0.8, 0.9));

class Swing : public testing::TestWithParam<int> {};

TEST_P(Swing, IsMotion) {
  const double period = GetParam();
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  NoiseOrMotion judge;
  const auto swing = [&](int i) {
    return 20.0 * std::sin(2 * std::numbers::pi * i / period) + normal(random);
  };
  EXPECT_EQ(called_noise(judge, 11, swing, [&](int) { return 2.0 * normal(random); }), 0);
}

INSTANTIATE_TEST_SUITE_P(Periods, Swing, testing::Values(20, 60, 150, 1000, 10'000));

TEST(NoiseOrMotion, ADriftIsNoPartOfTheNoise) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  NoiseOrMotion judge;
  const auto drift = [&](int i) { return 1e-3 * i + normal(random); };
  EXPECT_EQ(called_noise(judge, 11, drift, [&](int) { return normal(random); }), 10);
  EXPECT_NEAR(judge.variance(0), 1.0, 0.1);
}

// A structure that is struck once a window: as loud from one window to the next.
TEST(NoiseOrMotion, BlowsAreNotSteady) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double last = 0.0;
  const auto struck = [&](int i) {
    return last = (1.0 + 100.0 * std::exp(-(i % NoiseOrMotion::kWindow) / 500.0)) * normal(random);
  };
  NoiseOrMotion judge;
  EXPECT_EQ(called_noise(judge, 11, struck, [&](int) { return last; }), 0);
}

TEST(NoiseOrMotion, AWalkIsMotionAndABlowIsNotSteady) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double walk = 0.0;
  NoiseOrMotion walked;
  EXPECT_EQ(
      called_noise(
          walked, 11, [&](int) { return walk += normal(random); }, [&](int) { return 2.0 * normal(random); }),
      0);
  // A burst of noise for a window: the two before and after it disagree. Noise is never quieter than it is.
  NoiseOrMotion burst;
  double last = 0.0;
  const auto loud = [&](int i) {
    return last = (i / NoiseOrMotion::kWindow == 5 ? 30.0 : 1.0) * normal(random);
  };
  EXPECT_EQ(called_noise(burst, 6, loud, [&](int) { return last; }), 4);
  EXPECT_FALSE(burst.noise(0));
  EXPECT_NEAR(burst.variance(0), 1.0, 0.1);
  const auto quiet = [&](int) { return last = 0.5 * normal(random); };
  EXPECT_EQ(called_noise(burst, 1, quiet, [&](int) { return last; }), 0);
  EXPECT_EQ(burst.variance(0), 0.0);
}

}  // namespace
