// SPDX-License-Identifier: Apache-2.0
// Recordings smoothed of which samples are missing, or of whose noise nobody was told.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "tests/unit/estimator/drive.h"
#include "tests/unit/estimator/smooth_one.h"

namespace {

using namespace ifog::test;
using ifog::Axes;
using ifog::FilterSettings;

// Tumbling, one sample in twenty lost: a row that is absent is as good as one that is empty.
TEST(SmoothedRecord, AbsentRowsAreAsGoodAsEmptyOnes) {
  constexpr std::size_t kLength = 20'000;
  constexpr double kRatio = 1e-8;
  const Record r = record(71, kLength, kRatio, [](int i) {
    return 80'000.0 * std::sin(0.022 * i) * std::sin(0.0016 * i) + 34'000.0 * std::sin(0.041 * i);
  });
  std::mt19937 random(72);
  std::vector<double> empty = r.measured, absent, dt_s, truth;
  double since = 0.0;
  for (std::size_t i = 0; i < kLength; ++i) {
    since += kPeriod;
    if (i > 0 && random() % 20 == 0) {
      empty[i] = std::nan("");
      continue;
    }
    absent.push_back(r.measured[i]);
    truth.push_back(r.truth[i]);
    dt_s.push_back(std::exchange(since, 0.0));
  }
  const ifog::Smoothed of_empty = smooth_one(told(kRatio), empty);
  const ifog::Smoothed of_absent = smooth_one(told(kRatio), absent, dt_s);
  Judged judged;
  judged.add(of_absent, truth, 0, truth.size());
  EXPECT_LT(std::sqrt(judged.mean_square()), 0.6);
  EXPECT_GT(judged.nees(), 0.6);
  EXPECT_LT(judged.nees(), 1.3);
  double apart = 0.0, of_row = 0.0, of_cell = 0.0;
  for (std::size_t i = 0, k = 0; i < kLength; ++i) {
    if (!std::isfinite(empty[i])) continue;
    apart += std::pow(of_absent.rate_radps[k] - of_empty.rate_radps[i], 2);
    of_row += of_absent.variance_rad2ps2[k];
    of_cell += of_empty.variance_rad2ps2[i];
    ++k;
  }
  EXPECT_LT(apart, 0.05 * of_cell);
  EXPECT_NEAR(of_row / of_cell, 1.0, 0.02);
}

// Every other sample of the quiet axis of two comes, in a slow sway; settings are of the mean of both.
TEST(SmoothedRecord, AnAxisWithHalfOfItsSamplesHasItsOwnNoise) {
  constexpr std::size_t kLength = 60'000;
  constexpr double kRatio = 1e-10, kLoud = 30.0;
  Judged judged;
  for (std::uint64_t seed = 73; seed < 76; ++seed) {
    Record quiet = record(seed, kLength, kRatio, [](int i) { return 3.0 * std::sin(3e-4 * i); });
    Record loud = record(100 + seed, kLength, kRatio);
    for (std::size_t i = 0; i < kLength; ++i) {
      loud.measured[i] *= kLoud;
      if (i % 2 == 1) quiet.measured[i] = std::nan("");
    }
    const double mean = 0.5 * (1.0 + kLoud * kLoud);
    FilterSettings settings = told(kRatio, mean);
    settings.process_noise *= mean;
    const std::array<std::span<const double>, 2> rates{quiet.measured, loud.measured};
    const std::vector<double> dt_s(kLength, kPeriod);
    const Axes share{1.0 / mean, kLoud * kLoud / mean, 1.0};
    judged.add(ifog::smooth(settings, {share, share, false}, rates, dt_s, kPeriod)[0], quiet.truth, 0,
               kLength);
  }
  EXPECT_LT(std::sqrt(judged.mean_square()), 0.1);
  EXPECT_GT(judged.nees(), 0.3);
  EXPECT_LT(judged.nees(), 1.5);
}

// There are too few samples to detect it.
TEST(SmoothedRecord, AnAxisThatIsNotHeardHasTheNoiseDeclared) {
  constexpr std::size_t kLength = 5000;
  const Record seen = record(77, kLength, 1e-12);
  std::vector<double> hardly(kLength, std::nan(""));
  for (std::size_t i = 100; i < kLength; i += 1000) hardly[i] = 100.0 * seen.measured[i];
  const std::array<std::span<const double>, 2> rates{seen.measured, hardly};
  const std::vector<double> dt_s(kLength, kPeriod);
  FilterSettings settings = told(1e-12, 5000.5);
  const ifog::AxisNoise noise{Axes{2.0 / 10'001.0, 20'000.0 / 10'001.0, 1.0}, Axes{1.0, 1.0, 1.0}, false};
  const std::vector<ifog::Smoothed> got = ifog::smooth(settings, noise, rates, dt_s, kPeriod);
  // The mean of five measurements.
  EXPECT_NEAR(got[1].variance_rad2ps2[2500], 2000.0, 200.0);
}

}  // namespace
