// SPDX-License-Identifier: Apache-2.0
// The published variance against the error where the noise is not what a filter takes it for: with outliers,
// and with a motion that no tracker follows.
#include <gtest/gtest.h>

#include <numbers>

#include "filters/estimator/vibration.h"
#include "tests/unit/estimator/drive.h"

namespace {

using namespace ifog::test;

constexpr int kLength = 60'000;
constexpr std::size_t kSettled = 20'000;

// Mean of squared error over variance, of the samples from `from` on.
double squared_error_over_variance(const ifog::FilterSettings& settings, const Record& made,
                                   std::size_t from) {
  ifog::Estimator estimator(settings, 1, kPeriod);
  ifog::EstimatorInput in;
  ifog::EstimatorOutput out;
  in.dt_s = kPeriod;
  in.valid_axes = 1;
  double sum = 0.0;
  for (std::size_t i = 0; i < made.measured.size(); ++i) {
    in.sequence = i;
    in.rate_radps[0] = made.measured[i];
    estimator.step(in, out);
    const double error = out.denoised_radps[0] - made.truth[i];
    if (i >= from) sum += error * error / out.variance_rad2ps2[0];
  }
  return sum / static_cast<double>(made.measured.size() - from);
}

// One in a hundred stands twenty sigma off: too many to be passed over, so that the rate has them in it.
TEST(Honest, WithOutliers) {
  double mean = 0.0;
  constexpr int kSeeds = 3;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Record made = record(seed, kLength, 1e-3);
    std::mt19937_64 random(100 + seed);
    std::bernoulli_distribution outlier(0.01), upwards;
    for (double& z : made.measured)
      if (outlier(random)) z += upwards(random) ? 20.0 : -20.0;
    mean += squared_error_over_variance(told(1e-3), made, kSettled) / kSeeds;
  }
  EXPECT_GT(mean, 0.85);
  EXPECT_LT(mean, 1.1);
}

// A shake of a tenth of the sample rate, as loud as the noise: at rest it is filtered out, and the rate is
// off by it.
TEST(Honest, WithAVibrationThatIsTakenForNoise) {
  for (const double walk : {1e-4, 1e-7}) {
    const Record made = record(7, kLength, walk, [](int i) {
      const double grown = std::clamp((i - 20'000) / 1000.0, 0.0, 1.0);
      return grown * std::numbers::sqrt2 * std::sin(0.2 * std::numbers::pi * i + 0.01 * std::sin(0.001 * i));
    });
    const double found = squared_error_over_variance(told(walk), made, 24'000);
    EXPECT_LT(found, 1.25) << walk;
    EXPECT_GT(found, 0.8) << walk;
  }
}

class Draws {
 public:
  explicit Draws(unsigned seed) : random_(seed) {}
  // Squares and roughnesses of noise of those variances.
  void take(ifog::Vibration& by, int samples, double square, double rough) {
    for (int i = 0; i < samples; ++i) {
      const double a = normal_(random_), b = normal_(random_);
      by.take(square * a * a, rough * b * b);
    }
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

TEST(Vibration, IsWhatHasComeBesideTheUsual) {
  for (const double colour : {0.5, 1.0, 20.0}) {
    ifog::Vibration vibration;
    Draws draws(3);
    draws.take(vibration, 20'000, colour, 1.0);
    EXPECT_EQ(vibration.variance(), 0.0) << colour;
    draws.take(vibration, 20'000, 2.0 * colour, 1.0);
    EXPECT_NEAR(vibration.variance() / colour, 1.0, 0.25) << colour;
    draws.take(vibration, 20'000, colour, 1.0);
    EXPECT_EQ(vibration.variance(), 0.0) << colour;
  }
}

TEST(Vibration, IsNoneOfNoiseThatIsLouder) {
  ifog::Vibration vibration;
  Draws draws(4);
  for (int turn = 0; turn < 20; ++turn) {
    const double loud = turn % 2 == 0 ? 1.0 : 25.0;
    for (int i = 0; i < 40; ++i) {
      draws.take(vibration, 200, loud, loud);
      EXPECT_EQ(vibration.variance(), 0.0) << turn;
    }
  }
}

// What began in one is known as soon as it ends.
TEST(Vibration, ThatEndsIsTheNewUsual) {
  ifog::Vibration vibration;
  Draws draws(5);
  draws.take(vibration, 20'000, 3.0, 1.0);
  draws.take(vibration, 20'000, 1.0, 1.0);
  EXPECT_EQ(vibration.variance(), 0.0);
  draws.take(vibration, 20'000, 2.0, 1.0);
  EXPECT_NEAR(vibration.variance(), 1.0, 0.25);
  vibration.forget();
  EXPECT_EQ(vibration.variance(), 0.0);
}

}  // namespace
