// SPDX-License-Identifier: Apache-2.0
// The published variance against the error where the noise is not what a filter takes it for: with outliers,
// skewed or rounded, and with a motion that no tracker follows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/unit/estimator/drive.h"

namespace {

using namespace ifog::test;

constexpr int kLength = 60'000;
constexpr std::size_t kSettled = 20'000;

struct Judged {
  double error_over_variance = 0.0;  // mean of the squared error over the variance
  std::vector<double> variance;
};

// Over the samples from `from` on.
Judged judge(const ifog::FilterSettings& settings, const Record& made, std::size_t from) {
  Fed filter(settings);
  Judged found;
  for (std::size_t i = 0; i < made.measured.size(); ++i) {
    const ifog::EstimatorOutput& out = filter.step({made.measured[i]});
    if (i < from) continue;
    const double error = out.denoised_radps[0] - made.truth[i];
    found.variance.push_back(out.variance_rad2ps2[0]);
    found.error_over_variance += error * error / out.variance_rad2ps2[0];
  }
  found.error_over_variance /= static_cast<double>(found.variance.size());
  return found;
}

// The mean over records of the seeds 1 to `seeds` of the squared error over the variance, from `from` on.
double squared_error_over_variance(const ifog::FilterSettings& settings, std::uint64_t seeds,
                                   std::size_t from, const std::function<Record(std::uint64_t seed)>& made) {
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed)
    mean += judge(settings, made(seed), from).error_over_variance / static_cast<double>(seeds);
  return mean;
}

// Payments are errors until they are paid, and the variance says so. Where a ramp is followed the members of the mean
// have noise in common, which their spread counts twice.
TEST(Honest, AtRestAndOnARamp) {
  for (const bool moving : {false, true}) {
    const auto motion = [moving](int i) { return moving ? 2e-2 * std::max(0, i - 20'000) : 0.0; };
    const double mean = squared_error_over_variance(
        told(1e-4), 6, 22'000, [&](std::uint64_t seed) { return record(seed, kLength, 1e-4, motion); });
    EXPECT_GT(mean, moving ? 0.5 : 0.75) << (moving ? "ramp" : "rest");
    EXPECT_LT(mean, 1.25) << (moving ? "ramp" : "rest");
  }
}

// One in a hundred stands twenty sigma off.
TEST(Honest, WithOutliers) {
  const double mean = squared_error_over_variance(told(1e-3), 3, kSettled, [](std::uint64_t seed) {
    Record made = record(seed, kLength, 1e-3);
    std::mt19937_64 random(100 + seed);
    std::bernoulli_distribution outlier(0.01), upwards;
    for (double& z : made.measured)
      if (outlier(random)) z += upwards(random) ? 20.0 : -20.0;
    return made;
  });
  EXPECT_GT(mean, 0.85);
  EXPECT_LT(mean, 1.1);
}

// At rest between two steps of a converter five times as coarse as the noise, told that noise. The mean is
// off by nothing at the converter's own values and half way, and in between by 0.72.
Record rounded(std::uint64_t seed, double level) {
  constexpr double kStep = 5.0;
  Record made = record(seed, kLength, 0.0, [level](int) { return kStep * level; });
  for (double& z : made.measured) z = kStep * std::nearbyint(z / kStep);
  return made;
}

TEST(Honest, OverAllLevelsBetweenTwoStepsOfTheConverter) {
  constexpr int kLevels = 20;
  const double mean = squared_error_over_variance(told(1e-7), kLevels, kSettled, [](std::uint64_t level) {
    return rounded(8, (static_cast<double>(level) - 0.5) / kLevels);
  });
  EXPECT_LT(mean, 1.25);
  EXPECT_GT(mean, 0.8);
}

// A value that stays is no vibration, whatever the subtraction of it from itself leaves.
TEST(Honest, OfAConverterThatShowsOneValueForLong) {
  Record made = rounded(10, 0.01);
  for (std::size_t i = 0; i < made.measured.size(); ++i) {
    const double offset = 0.1;  // no whole number of bits
    made.truth[i] += offset;
    made.measured[i] = (i / 1024 % 2 == 1 ? 0.0 : made.measured[i]) + offset;
  }
  const std::vector<double> variance = judge(told(1e-5), made, kSettled).variance;
  // Nothing that moves within a step is further off than the step is wide.
  EXPECT_LT(*std::max_element(variance.begin(), variance.end()), 25.0);
}

// What is clipped of a measurement, lest it look like a change, has a mean of its own there. It is known long before the
// longest sums of a slow filter that it is among. Against the settled Kalman filter's variance, by Riccati's equation.
TEST(Honest, InSkewedNoise) {
  struct Case {
    double walk;
    std::uint64_t first_seed, seeds;
    int length, settled;
    double within;
  };
  for (const Case& one :
       {Case{1e-6, 11, 8, 3 * kLength, kLength, 0.08}, Case{1e-9, 21, 4, 300'000, 150'000, 0.15}}) {
    double mean = 0.0;
    for (std::uint64_t seed = one.first_seed; seed < one.first_seed + one.seeds; ++seed) {
      Record made = record(seed, one.length, one.walk);
      std::mt19937_64 random(100 + seed);
      std::exponential_distribution<double> exponential;
      for (std::size_t i = 0; i < made.measured.size(); ++i)
        made.measured[i] = made.truth[i] + exponential(random) - 1.0;
      std::vector<double> variance =
          judge(told(one.walk), made, static_cast<std::size_t>(one.settled)).variance;
      const auto middle = variance.begin() + static_cast<std::ptrdiff_t>(variance.size() / 2);
      std::nth_element(variance.begin(), middle, variance.end());
      mean += *middle / static_cast<double>(one.seeds);
    }
    const double predicted = 0.5 * (one.walk + std::sqrt(one.walk * one.walk + 4.0 * one.walk));
    EXPECT_NEAR(mean / (predicted / (1.0 + predicted)), 1.0, one.within) << one.walk;
  }
}

// What may be a change that begins is a sign of one as seldom, over however many lengths it is looked for.
TEST(Honest, AtRestOfAFilterThatIsSlow) {
  constexpr double kWalk = 1e-9;
  constexpr int kFew = 150'000, kSeeds = 4;
  double beyond = 0.0, all = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<double> variance =
        judge(told(kWalk), record(50 + seed, 3 * kFew, kWalk), kFew).variance;
    for (const double one : variance) {
      beyond += one > 2.0 * std::sqrt(kWalk) ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  EXPECT_LT(beyond / all, 0.15);
}

// A tracker's lag in a sea is paid back as it comes: the two are no two errors.
TEST(Honest, InASea) {
  const double mean = squared_error_over_variance(told(1e-6), 3, kSettled, [](std::uint64_t seed) {
    return record(30 + seed, kLength, 1e-6, [](int i) {
      return i < 20'000 ? 0.0 : 3.0 * std::sin(2.0 * std::numbers::pi * (i - 20'000) / 2000.0);
    });
  });
  EXPECT_GT(mean, 0.8);
  EXPECT_LT(mean, 1.25);
}

// A swing looks like rest where it turns, again and again, and what the filter then lags behind by is no
// colour, however long it goes on.
TEST(Honest, InASwingOfHours) {
  constexpr int kLong = 1'200'000;
  constexpr double kSwing = 10'000.0;
  const Record made = record(60, kLong, 1e-9, [](int i) {
    return i < 200'000 ? 0.0 : 30.0 * std::sin(2.0 * std::numbers::pi * (i - 200'000) / kSwing);
  });
  const double found = judge(told(1e-9), made, 400'000).error_over_variance;
  EXPECT_GT(found, 0.8);
  EXPECT_LT(found, 1.25);
}

}  // namespace
