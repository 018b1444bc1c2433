// SPDX-License-Identifier: Apache-2.0
// Noise from start-up data against the noise it was made with.
#include "filters/estimator/start_up.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "filters/estimator/first_samples.h"
#include "tests/unit/estimator/drive.h"

namespace {

using namespace ifog::test;

TEST(StartUp, FindsTheNoiseThroughDriftMotionAndMissingSamples) {
  for (const double ratio : {1e-1, 1e-3}) {
    double plain_q = 0, plain_r = 0, rough_q = 0, rough_r = 0;
    constexpr int kSeeds = 10;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      Record r = record(seed, 20'000, ratio);
      const auto plain = ifog::estimate_noise(r.measured, 1, kPeriod);
      for (std::size_t i = 0; i < r.measured.size(); ++i) {
        r.measured[i] += 1e-4 * static_cast<double>(i);
        if (i % 10 == 3) r.measured[i] = std::numeric_limits<double>::quiet_NaN();
        if (i > 8000 && i < 12'000) r.measured[i] += 200 * std::sin(0.01 * static_cast<double>(i));
      }
      const auto rough = ifog::estimate_noise(r.measured, 1, kPeriod);
      plain_q += std::log(plain.process_noise * kPeriod / ratio) / kSeeds;
      plain_r += std::log(plain.measurement_noise) / kSeeds;
      rough_q += std::log(rough.process_noise * kPeriod / ratio) / kSeeds;
      rough_r += std::log(rough.measurement_noise) / kSeeds;
    }
    EXPECT_NEAR(plain_r, 0.0, 0.1) << ratio;
    EXPECT_NEAR(plain_q, 0.0, 0.7) << ratio;
    EXPECT_NEAR(rough_r, 0.0, 0.3) << ratio;
    EXPECT_NEAR(rough_q, 0.0, std::log(8.0)) << ratio;  // a fifth of the record is motion
  }
}

// The longest octave, 256 samples with some nine independent differences, knows 6 R / 256 to a half, and q to
// 4.5e-5: neither a walk that the record surely does not have nor one too slow to be told from none. Single
// records scatter by more, as medians do.
TEST(StartUp, OfWhiteNoiseIsAWalkThatTheRecordMightHide) {
  std::vector<double> walks;
  for (std::uint64_t seed = 1; seed <= 21; ++seed) {
    const Record r = record(seed, 5000, 0.0);
    const auto found = ifog::estimate_noise(r.measured, 1, kPeriod);
    EXPECT_NEAR(found.measurement_noise, 1.0, 0.15);
    walks.push_back(found.process_noise * kPeriod);
  }
  std::sort(walks.begin(), walks.end());
  EXPECT_LT(walks[10], 2.0 * 4.5e-5);
  EXPECT_GT(walks[10], 0.5 * 4.5e-5);
  EXPECT_GT(walks.front(), 1e-6);
  EXPECT_LT(walks.back(), 1e-3);
}

// The normalised squared error of each of the first samples, over many records, is 1 at most, and 1 once a
// dozen have come.
TEST(StartUp, TheVarianceIsHonestFromTheFirstSampleOn) {
  constexpr int kRecords = 20'000, kSamples = 40;
  for (const double level : {0.0, 100.0}) {
    std::mt19937_64 random(9);
    std::normal_distribution<double> normal;
    std::vector<double> nees(kSamples, 0.0);
    for (int r = 0; r < kRecords; ++r) {
      ifog::FirstSamples first;
      for (double& sum : nees) {
        const double error = normal(random);
        sum += error * error / first.variance(0, level + error, true) / kRecords;
      }
    }
    for (int i = 0; i < kSamples; ++i) {
      EXPECT_LT(nees[static_cast<std::size_t>(i)], 1.1) << level << ", sample " << i;
      if (i >= 11) {
        EXPECT_GT(nees[static_cast<std::size_t>(i)], 0.8) << level << ", sample " << i;
      }
    }
  }
}

TEST(StartUp, AveragesTheAxesThatMeasure) {
  std::vector<double> both = record(1, 5000, 1e-3).measured;
  for (const double r : record(2, 5000, 1e-3).measured) both.push_back(3.0 * r + 7.0);
  const auto found = ifog::estimate_noise(both, 2, kPeriod);
  EXPECT_NEAR(found.measurement_noise, (1.0 + 9.0) / 2, 0.5);
  const auto first = ifog::estimate_noise(std::span(both).first(5000), 1, kPeriod);
  both.resize(15'000, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 5000; i < both.size(); ++i) both[i] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ifog::estimate_noise(both, 3, kPeriod).measurement_noise, first.measurement_noise);
}

// A swing is no noise, whatever the sample rate: it is said, and the noise is what is rough.
TEST(StartUp, TellsAMotionFromNoise) {
  constexpr double kNoise = 1.5e-6;  // rad/s in one second
  for (const double rate_hz : {10.0, 25.0, 50.0, 100.0, 200.0})
    for (const double amplitude : {0.02, 0.1}) {  // rad/s
      const auto length = static_cast<std::size_t>(std::max(256.0, 4.0 * rate_hz));
      const double noise = kNoise * kNoise * rate_hz;
      std::mt19937_64 random(11);
      std::normal_distribution<double> normal(0.0, std::sqrt(noise));
      std::vector<double> rate(length);
      double rough = 0.0;  // what a swing leaves in third differences
      for (std::size_t i = 0; i < length; ++i)
        rate[i] = amplitude * std::cos(0.2 * std::numbers::pi * static_cast<double>(i) / rate_hz + 0.3) +
                  normal(random);
      rough =
          0.5 * std::pow(2.0 * std::sin(0.1 * std::numbers::pi / rate_hz), 6) * amplitude * amplitude / 20.0;
      const auto found = ifog::estimate_noise(rate, 1, 1.0 / rate_hz);
      EXPECT_TRUE(found.moved) << rate_hz << " " << amplitude;
      EXPECT_LT(found.measurement_noise, 1.6 * noise + 2.0 * rough) << rate_hz << " " << amplitude;
      EXPECT_GT(found.measurement_noise, 0.5 * noise) << rate_hz << " " << amplitude;
    }
}

TEST(StartUp, TakesNoNoiseForAMotion) {
  for (const int length : {256, 800, 5000})
    for (const double walk : {0.0, 1e-3, 1e-1, 10.0})
      for (const double correlation : {0.0, 0.9, 0.99})
        for (std::uint64_t seed = 1; seed <= 30; ++seed) {
          Record r = record(seed, length, walk);
          double noise = 0.0;
          for (std::size_t i = 0; i < r.measured.size(); ++i) {
            noise = correlation * noise + r.measured[i] - r.truth[i];
            r.measured[i] = r.truth[i] + noise;
          }
          EXPECT_FALSE(ifog::estimate_noise(r.measured, 1, kPeriod).moved)
              << length << " " << walk << " " << correlation << " " << seed;
        }
}

TEST(StartUp, RefusesTooShortARecordAndSurvivesAConstantOne) {
  EXPECT_THROW((void)ifog::estimate_noise(std::vector<double>(31, 1.0), 1, kPeriod), std::invalid_argument);
  const auto constant = ifog::estimate_noise(std::vector<double>(1000, 0.5), 1, kPeriod);
  EXPECT_GT(constant.measurement_noise, 0.0);
  EXPECT_GT(constant.process_noise, 0.0);
}

// Of a fast motion, whichever samples of it come; a row that is absent is as good as an empty one.
TEST(StartUp, HearsRoughnessBetweenMissingSamples) {
  constexpr int kLength = 20'000;
  const Record r = record(9, kLength, 0.0, [](int i) { return 1000.0 * std::sin(0.02 * i); });
  for (const int every : {2, 3, 20}) {
    std::vector<double> rate, present, steps;
    double since = 0.0;
    for (int i = 0; i < kLength; ++i) {
      const bool lost = every == 20 ? i % every == 7 : i % every != 0;
      since += 1.0;
      rate.push_back(lost ? std::nan("") : r.measured[static_cast<std::size_t>(i)]);
      if (lost) continue;
      present.push_back(rate.back());
      steps.push_back(std::exchange(since, 0.0));
    }
    EXPECT_NEAR(ifog::roughness(rate), 1.0, 0.1) << every;
    EXPECT_NEAR(ifog::roughness(present, steps), 1.0, 0.1) << every;
  }
}

}  // namespace
