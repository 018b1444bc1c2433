// The estimate against the Q and R that the record was drawn with.
#include "filters/chain/startup_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace ifog {
namespace {

std::vector<double> drawn(double q, double r, double period_s, std::size_t n, unsigned seed, double level) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> out(n);
  double state = level;
  for (double& value : out) {
    state += std::sqrt(q * period_s) * normal(engine);
    value = state + std::sqrt(r) * normal(engine);
  }
  return out;
}

TEST(StartupNoise, FindsWhiteNoiseAndRandomWalk) {
  constexpr double kPeriod_s = 1e-3, kR = 4e-10, kQ = 4e-10;  // Q T / R = 1e-3
  double q = 0.0, r = 0.0;
  constexpr int kSeeds = 20;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const StartupNoise found = startup_noise(drawn(kQ, kR, kPeriod_s, 4000, seed, 0.3), 1, kPeriod_s);
    q += found.process_noise / kSeeds;
    r += found.measurement_noise / kSeeds;
    EXPECT_NEAR(found.measurement_noise, kR, 0.15 * kR) << seed;
  }
  EXPECT_NEAR(r, kR, 0.03 * kR);
  EXPECT_NEAR(q, kQ, 0.4 * kQ);
}

TEST(StartupNoise, WithoutARandomWalkTheProcessNoiseIsSmallButNotZero) {
  constexpr double kPeriod_s = 5e-3, kR = 1e-8;
  const StartupNoise found = startup_noise(drawn(0.0, kR, kPeriod_s, 2000, 3, -2.0), 1, kPeriod_s);
  EXPECT_NEAR(found.measurement_noise, kR, 0.1 * kR);
  EXPECT_GT(found.process_noise, 0.0);
  EXPECT_LT(found.process_noise * kPeriod_s / found.measurement_noise, 1e-3);
}

TEST(StartupNoise, ARecordThatNeverChangesStillGivesAFilterThatRuns) {
  const StartupNoise found = startup_noise(std::vector<double>(500, 0.25), 1, 1e-3);
  EXPECT_GT(found.measurement_noise, 0.0);
  EXPECT_GT(found.process_noise, 0.0);
}

TEST(StartupNoise, AxesAreAveraged) {
  constexpr double kPeriod_s = 1e-3;
  std::vector<double> both = drawn(0.0, 1e-8, kPeriod_s, 5000, 1, 0.0);
  const std::vector<double> second = drawn(0.0, 3e-8, kPeriod_s, 5000, 2, 5.0);
  both.insert(both.end(), second.begin(), second.end());
  EXPECT_NEAR(startup_noise(both, 2, kPeriod_s).measurement_noise, 2e-8, 0.1e-8);
}

}  // namespace
}  // namespace ifog
