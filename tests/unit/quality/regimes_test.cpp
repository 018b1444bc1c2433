// SPDX-License-Identifier: Apache-2.0
// The records of the regime bench as a whole, its conventional filter against closed forms, and the bench's
// own zero: a filter measured against itself.
#include "tests/bench/quality/regimes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/bench/quality/trial.h"

namespace {

using ifog::bench::Filtered;
using ifog::bench::Regime;
using ifog::bench::RegimeRecord;

const Regime& regime(const std::string& name) {
  const auto& all = ifog::bench::regimes();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Regime& r) { return r.name == name; });
  if (found == all.end()) throw std::invalid_argument("no regime " + name);
  return *found;
}

TEST(Regimes, EveryRecordIsWhole) {
  std::set<std::string> names;
  for (const Regime& one : ifog::bench::regimes()) {
    SCOPED_TRACE(one.name);
    EXPECT_TRUE(names.insert(one.name).second);
    const RegimeRecord record = one.make(1e-3, 1);
    ASSERT_EQ(record.truth.size(), record.measured.size());
    EXPECT_TRUE(record.noise_variance.empty() || record.noise_variance.size() == record.truth.size());
    // Records that move from the first sample on are judged after half a second; the others once at rest.
    EXPECT_GE(record.from, one.judge_raw_only ? 50U : 20'000U);
    EXPECT_GE(record.truth.size(), record.from + 2000);
    EXPECT_TRUE(
        std::all_of(record.truth.begin(), record.truth.end(), [](double x) { return std::isfinite(x); }));
    const auto missing =
        std::count_if(record.measured.begin(), record.measured.end(), [](double x) { return std::isnan(x); });
    EXPECT_EQ(missing > 0, one.name.starts_with("missing"));
    EXPECT_GE(one.limit_at(1e-3), one.limit_at(1e-6));
  }
  // 33 of the limits' table, two of followed noise; four vehicles at three rates and twelve starts, noise given or not.
  EXPECT_EQ(names.size(), 33U + 2 + 2 * (4 * 3 + 12));
}

// Increments of the walk and the noise on top, at rest and before every motion. The squares of Gaussians
// scatter by √(2/n) of their mean.
TEST(Regimes, WalkAndNoiseHaveTheirVariances) {
  for (const double ratio : {1e-3, 1e-6}) {
    for (const char* name : {"gaussian", "sea-30", "turns-30", "ramp-1e-1"}) {
      const RegimeRecord record = regime(name).make(ratio, 3);
      double walk = 0.0, noise = 0.0;
      for (std::size_t i = 1; i < 20'000; ++i) {
        walk += std::pow(record.truth[i] - record.truth[i - 1], 2);
        noise += std::pow(record.measured[i] - record.truth[i], 2);
      }
      constexpr double kCount = 19'999.0;
      EXPECT_NEAR(walk / kCount / ratio, 1.0, 5.0 * std::sqrt(2.0 / kCount)) << name;
      EXPECT_NEAR(noise / kCount, 1.0, 5.0 * std::sqrt(2.0 / kCount)) << name;
    }
  }
}

// Without a walk the estimate is the mean of all so far, its variance one over their number.
TEST(Conventional, WithoutAWalkIsTheMean) {
  RegimeRecord record;
  record.measured = {3.0, 5.0, std::nan(""), 10.0};
  const Filtered got = ifog::bench::conventional(record, 0.0, false);
  EXPECT_DOUBLE_EQ(got.value[0], 3.0);
  EXPECT_DOUBLE_EQ(got.value[1], 4.0);
  EXPECT_DOUBLE_EQ(got.value[2], 4.0);
  EXPECT_DOUBLE_EQ(got.value[3], 6.0);
  EXPECT_DOUBLE_EQ(got.variance[2], 1.0 / 2.0);
  EXPECT_DOUBLE_EQ(got.variance[3], 1.0 / 3.0);
}

// The steady state of the Riccati equation with R = 1: P = (√(Q² + 4Q) − Q)/2 after the update.
TEST(Conventional, SettlesAtRiccatisVariance) {
  RegimeRecord record;
  record.measured.assign(20'000, 0.0);
  for (const double ratio : {1e-1, 1e-3, 1e-6}) {
    const double steady = 0.5 * (std::sqrt(ratio * ratio + 4.0 * ratio) - ratio);
    EXPECT_NEAR(ifog::bench::conventional(record, ratio, false).variance.back() / steady, 1.0, 1e-9);
  }
}

// The project's own conventional filter, driven as the daemon drives it, is the one written by hand; and that
// one knows its error: mean of (estimate − truth)²/P of 1, which scatters by √(2τ/T) over T samples with a
// time constant of τ.
TEST(Judge, TheConventionalFilterScoresOne) {
  const auto figures = ifog::bench::judge(regime("gaussian"), "ckf", 1e-3, 5);
  EXPECT_NEAR(figures.over_conventional, 1.0, 1e-3);
  EXPECT_NEAR(figures.nees / figures.nees_conventional, 1.0, 5e-3);
  const double scatter = std::sqrt(2.0 / std::sqrt(1e-3) / static_cast<double>(figures.judged));
  EXPECT_NEAR(figures.nees_conventional, 1.0, 5.0 * scatter);
  EXPECT_LT(figures.over_better, 1.001);
  EXPECT_TRUE(std::isnan(figures.over_informed));
}

}  // namespace
