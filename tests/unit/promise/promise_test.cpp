// SPDX-License-Identifier: Apache-2.0
// Oracles: ordinary least squares in closed form where the noise is white, and how often the intervals hold
// the truth that was put in.
#include "filters/promise/promise.h"
#include "filters/promise/running_trial.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kPeriod_s = 0.1;

struct Made {
  std::vector<double> time_s, before, after;
  std::vector<Stretch> at_rest;
  [[nodiscard]] CorrectionTrial trial() const { return {time_s, before, after, at_rest}; }
};

// before = bias + share * d + noise, d a slow swing of `swing`.
Made made(std::size_t n, double share, double swing, double walk, unsigned seed) {
  test::Noise normal(seed);
  Made out;
  double level = 7.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) * kPeriod_s;
    const double d = swing * std::sin(2.0 * std::numbers::pi * t / 400.0);
    level += walk * normal();
    const double e = level + share * d + normal();
    out.time_s.push_back(t);
    out.before.push_back(e);
    out.after.push_back(e - d);
  }
  out.at_rest = {{0, n}};
  return out;
}

struct LeastSquares {
  double share = 0.0, error = 0.0;  // for noise of 1
};

// With a constant, on means over `each` samples.
LeastSquares on_means(const Made& data, std::size_t each) {
  std::vector<double> d, e;
  for (std::size_t i = 0; i < data.before.size(); i += each) {
    const std::size_t end = std::min(i + each, data.before.size());
    const auto mean = [&](const std::vector<double>& of) {
      return std::accumulate(&of[i], &of[i] + (end - i), 0.0) / static_cast<double>(end - i);
    };
    e.push_back(mean(data.before));
    d.push_back(e.back() - mean(data.after));
  }
  const auto n = static_cast<double>(d.size());
  const double d_mean = std::accumulate(d.begin(), d.end(), 0.0) / n,
               e_mean = std::accumulate(e.begin(), e.end(), 0.0) / n;
  double dd = 0.0, de = 0.0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    dd += (d[i] - d_mean) * (d[i] - d_mean);
    de += (d[i] - d_mean) * (e[i] - e_mean);
  }
  return {de / dd, 1.0 / std::sqrt(dd)};
}

TEST(Promise, InWhiteNoiseItIsLeastSquares) {
  const Made data = made(20000, 0.9, 0.3, 0.0, 1);
  const LeastSquares expected = on_means(data, 1);
  const PromiseKept kept = weigh_promise(data.trial());
  EXPECT_EQ(kept.walk_ratio, 0.0);
  EXPECT_NEAR(kept.share, expected.share, 1e-9);
  EXPECT_NEAR(kept.share_error, expected.error, 0.35 * expected.error);
  EXPECT_DOUBLE_EQ(kept.seconds, 2000.0);
}

TEST(Promise, ItsIntervalsHoldTheTruthInSlowNoise) {
  int held = 0;
  double squares = 0.0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const PromiseKept kept =
        weigh_promise(made(6000, 1.0, 0.5, 0.01, 100 + static_cast<unsigned>(trial)).trial());
    const double off = (kept.share - 1.0) / kept.share_error;
    squares += off * off / kTrials;
    if (std::abs(off) < 1.96) ++held;
  }
  // 95 % of 300 is 285 +- 4; an error of the share that is a little large is no fault.
  EXPECT_GE(held, 273);
  EXPECT_GT(squares, 0.5);
  EXPECT_LT(squares, 1.3);
}

TEST(Promise, VerdictsAreThoseOfWhatWasPutIn) {
  EXPECT_EQ(verdict(weigh_promise(made(40000, 1.0, 0.5, 0.001, 2).trial())), PromiseVerdict::kept);
  EXPECT_EQ(verdict(weigh_promise(made(40000, 0.75, 0.5, 0.001, 3).trial())), PromiseVerdict::in_part);
  EXPECT_EQ(verdict(weigh_promise(made(40000, 0.0, 0.5, 0.001, 4).trial())), PromiseVerdict::broken);
  EXPECT_EQ(verdict(weigh_promise(made(40000, 1.0, 0.002, 0.001, 5).trial())), PromiseVerdict::open);
}

TEST(Promise, ACorrectionThatDoesNotMoveIsLeftOpen) {
  Made data = made(1000, 1.0, 0.5, 0.0, 6);
  for (std::size_t i = 0; i < data.after.size(); ++i) data.after[i] = data.before[i] - 0.25;
  const PromiseKept kept = weigh_promise(data.trial());
  EXPECT_TRUE(std::isinf(kept.share_error));
  EXPECT_EQ(verdict(kept), PromiseVerdict::open);
}

TEST(Promise, WhatMovesAndWhatIsMissingDoesNotCount) {
  Made data = made(20000, 1.0, 0.5, 0.001, 7);
  for (std::size_t i = 5000; i < 9000; ++i) data.before[i] = data.after[i] = 1e3;  // turned
  for (std::size_t i = 12000; i < 12100; ++i) data.before[i] = data.after[i] = std::nan("");
  data.at_rest = {{0, 5000}, {9000, 20000}};
  const PromiseKept kept = weigh_promise(data.trial());
  EXPECT_NEAR(kept.seconds, 1590.0, 1e-6);
  EXPECT_EQ(verdict(kept), PromiseVerdict::kept);
  ASSERT_EQ(kept.errors.size(), 3U);
  // A sine of 0.5 has a root mean square of 0.354; white noise of 1 leaves 0.1 of ten-second means.
  EXPECT_NEAR(kept.errors[1].before_radps, std::sqrt(0.125 + 0.01), 0.03);
  EXPECT_LT(kept.errors[1].after_radps, 0.2);
}

TEST(Promise, TooLittleIsRefused) {
  EXPECT_THROW(weigh_promise(made(99, 1.0, 0.5, 0.0, 8).trial()), std::invalid_argument);
  Made moving = made(1000, 1.0, 0.5, 0.0, 9);
  moving.at_rest = {{0, 50}};
  EXPECT_THROW(weigh_promise(moving.trial()), std::invalid_argument);
  moving.after.pop_back();
  EXPECT_THROW(weigh_promise(moving.trial()), std::invalid_argument);
}

// Rates of a gyro: `made` in units of 1e-5 rad/s.
RunningTrial running(const Made& data, double every_s) {
  RunningTrial trial(1);
  for (std::size_t i = 0; i < data.before.size(); ++i) {
    const std::array<double, 1> before{1e-5 * data.before[i]}, after{1e-5 * data.after[i]};
    trial.add(static_cast<double>(i) * every_s, before, after);
  }
  return trial;
}

TEST(RunningTrial, WeighsMeansOfASecondAndOfAsManyAsALongRecordNeeds) {
  const Made data = made(50000, 0.9, 0.8, 0.0, 8);
  const auto seconds = running(data, 0.1).weigh(0);  // 5000 s
  ASSERT_TRUE(seconds);
  EXPECT_FALSE(seconds->denied);
  EXPECT_NEAR(seconds->share, on_means(data, 10).share, 1e-6);
  const auto widened = running(data, 1.0).weigh(0);  // 50000 s: 16384 means at most, of 4 s
  ASSERT_TRUE(widened);
  EXPECT_NEAR(widened->share, on_means(data, 4).share, 1e-6);
}

TEST(RunningTrial, ACauseThatOnlyRanAlongIsBroken) {
  const auto absent = running(made(50000, 0.0, 0.5, 0.001, 9), 0.1).weigh(0);
  ASSERT_TRUE(absent);
  EXPECT_TRUE(absent->denied);
  EXPECT_NEAR(absent->share, 0.0, 4.0 * absent->share_error);
}

TEST(RunningTrial, SaysNothingOfASensorThatTurnsOrOfSeconds) {
  EXPECT_FALSE(running(made(900, 1.0, 0.5, 0.0, 10), 0.1).weigh(0));  // 90 s
  // On a table that swings by 0.01 rad/s, with a scale factor that is corrected: half of the rate's swing,
  // backwards.
  EXPECT_FALSE(running(made(50000, -2.0, 500.0, 0.0, 11), 0.1).weigh(0));
}

}  // namespace
}  // namespace ifog
