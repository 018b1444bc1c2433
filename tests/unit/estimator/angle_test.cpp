// SPDX-License-Identifier: Apache-2.0
// The angle: integral of (denoised - measured) back at zero after manoeuvres, and coning not rectified.
#include "filters/units/field_units.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;

using ifog::kDegree;

TEST(Heading, IsKeptOverTurnsByHand) {
  const std::string path = std::string(IFOG_SHARED_DATA) + "/kvh1750_direct_imu_rate.csv.gz";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << path << " is not there; the shared captures beside the project make this run";
  const ifog::Capture capture = ifog::read_capture(path);
  const double period = 0.001;
  ifog::FilterSettings settings;
  for (const auto& axis : capture.rate_radps)
    for (std::size_t i = 1; i < 1500; ++i)  // before the first turn
      settings.measurement_noise += std::pow(axis[i] - axis[i - 1], 2) / 2.0 / 1499.0 / 3.0;
  settings.process_noise = 1e-6 * settings.measurement_noise / period;
  Fed filter(settings, 3, period);
  std::array<double, 3> lost{};
  for (std::size_t i = 0; i < capture.size(); ++i) {
    const ifog::Axes rate{capture.rate_radps[0][i], capture.rate_radps[1][i], capture.rate_radps[2][i]};
    const ifog::EstimatorOutput& out = filter.step(rate);
    for (std::size_t a = 0; a < 3; ++a) lost[a] += (out.denoised_radps[a] - rate[a]) * period;
    ASSERT_EQ(out.gain[0], out.gain[1]);
    ASSERT_EQ(out.gain[0], out.gain[2]);
  }
  for (const double angle : lost) EXPECT_LT(std::abs(angle), 0.001 * kDegree);
}

// Allan deviation over m samples, overlapping, from second differences of the angle (IEEE Std 952).
double allan(const std::vector<double>& angle, std::size_t m) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 2 * m < angle.size(); ++i)
    sum += std::pow(angle[i + 2 * m] - 2 * angle[i + m] + angle[i], 2);
  return std::sqrt(sum / static_cast<double>(angle.size() - 2 * m) / 2.0) / static_cast<double>(m);
}

// A rotational seismometer on a bridge that is struck with a hammer for two hours, with the noise that tune
// finds in it: what is published keeps the angle, and over a hundred seconds is no louder than what was
// measured.
TEST(Heading, IsKeptOnABridgeUnderHammerBlows) {
  const std::string path = std::string(IFOG_SHARED_DATA) + "/blueseis_bridge_rbam2.csv.gz";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << path << " is not there; the shared captures beside the project make this run";
  const ifog::Capture capture = ifog::read_capture(path);
  constexpr double kStep = 0.005;
  constexpr std::size_t kHundredSeconds = 20'000;
  ifog::FilterSettings settings;
  settings.process_noise = 1.517e-19;
  settings.measurement_noise = 4.154e-11;
  Fed filter(settings, 1, kStep);
  std::vector<double> denoised{0.0}, measured{0.0};
  double apart = 0.0;
  for (const double rate : capture.rate_radps[0]) {
    denoised.push_back(denoised.back() + filter.step({rate}).denoised_radps[0]);
    measured.push_back(measured.back() + rate);
    apart = std::max(apart, std::abs(denoised.back() - measured.back()) * kStep);
  }
  EXPECT_LT(apart, 0.04 * kDegree);
  EXPECT_LT(allan(denoised, kHundredSeconds), 1.1 * allan(measured, kHundredSeconds));
}

// A filter takes the place of another in every sample around the sharp start of a turn, as a reload does, and
// nothing it keeps out is forgotten: what is owed and what was lost cancel but for a measurement's noise.
TEST(Heading, IsKeptWhereAFilterIsNewAtTheStartOfATurn) {
  constexpr double kStep = 2e-4, kNoise = 1e-4, kTurn = 1.7;
  constexpr std::uint64_t kStart = 200, kEnd = 3000;
  ifog::FilterSettings settings;
  settings.process_noise = settings.measurement_noise = kNoise * kNoise;
  double most = 0.0;
  for (std::uint64_t reload = kStart - 160; reload < kStart + 20; ++reload) {
    Noise normal(reload);
    Fed filter(settings, 2, kStep);
    std::array<double, 2> lost{};
    for (std::uint64_t i = 0; i < kEnd; ++i) {
      if (i == reload) {
        const ifog::Axes owed = filter.estimator.owed();
        filter.estimator = ifog::Estimator(settings, 2, kStep);
        filter.estimator.owe(owed);
      }
      const double t = static_cast<double>(i) * kStep;
      const double turn = (i < kStart ? 0.0 : kTurn) + kNoise * normal();
      const ifog::Axes rate{turn, 0.1 * std::sin(0.7 * t) + kNoise * normal()};
      const ifog::EstimatorOutput& out = filter.step(rate);
      for (std::size_t a = 0; a < 2; ++a) lost[a] += (out.denoised_radps[a] - rate[a]) * kStep;
    }
    const ifog::Axes owed = filter.estimator.owed();
    for (std::size_t a = 0; a < 2; ++a) most = std::max(most, std::abs(lost[a] + owed[a]));
  }
  EXPECT_LT(most, 6.0 * kNoise * kStep);
}

// Jumps of one axis beside one that has noise only. The first measurement of the first one is kept out of both until
// it is known what it was, and then is owed: once, whatever comes at rest afterwards. Those of later ones are published.
TEST(Heading, WhatWasKeptOutOfAJumpIsOwedOnce) {
  Fed filter(told(1e-6), 2);
  Noise normal(5);
  std::array<double, 2> lost{};
  for (std::uint64_t i = 0; i < 200'000; ++i) {
    const double jumps = (i / 2000 % 2 == 0 ? 0.0 : 20.0) + std::clamp(normal(), -4.0, 4.0);
    const ifog::Axes rate{jumps, std::clamp(normal(), -4.0, 4.0)};
    const ifog::EstimatorOutput& out = filter.step(rate);
    for (std::size_t a = 0; a < 2; ++a) lost[a] += (out.denoised_radps[a] - rate[a]) * kPeriod;
  }
  EXPECT_EQ(filter.estimator.health().gated, 1U);
  for (std::size_t a = 0; a < 2; ++a) EXPECT_NEAR(lost[a] + filter.estimator.owed()[a], 0.0, 1e-6) << a;
}

TEST(Heading, IsKeptOverATurnWithASharpStartAndASlowStop) {
  // 1 kHz, angle random walk 0.01 deg/sqrt(h): 50 deg/s at once, then away over ten seconds.
  const double period = 1e-3, noise = 0.01 * kDegree / 60 / std::sqrt(period);
  for (const double ratio : {1e-3, 1e-5}) {
    ifog::FilterSettings settings;
    settings.measurement_noise = noise * noise;
    settings.process_noise = ratio * noise * noise / period;
    Fed filter(settings, 1, period);
    Noise normal(8);
    double lost = 0.0, mean = 0.0;
    for (int i = 0; i < 60'000; ++i) {
      const double t = i * period - 5.0;
      const double turn =
          t < 0 || t > 15
              ? 0.0
              : 50 * kDegree * (t < 5 ? 1.0 : 0.5 + 0.5 * std::cos((t - 5) / 10 * std::numbers::pi));
      const double rate = turn + noise * normal();
      lost += (filter.step({rate}).denoised_radps[0] - rate) * period;
      // What is left wanders with the noise the filter has not yet taken in; a mean over ten seconds tells it
      // from loss.
      if (i >= 50'000) mean += lost / 10'000;
    }
    EXPECT_GT(filter.estimator.health().manoeuvres, 0U);
    EXPECT_LT(std::abs(mean), 0.001 * kDegree) << "Q/R " << ratio;
  }
}

// A filter that cannot keep up gets means of now two, now nine samples, and starts in the turn: what it owes
// is counted in time, not in samples, and a rate seen through different scales is no noise.
TEST(Heading, IsKeptWhereSamplesAreMergedUnevenly) {
  const double period = 1e-3, noise = 0.01 * kDegree / 60 / std::sqrt(period);
  ifog::FilterSettings settings;
  settings.measurement_noise = noise * noise;
  settings.process_noise = 1e-3 * noise * noise / period;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Fed filter(settings, 1, period);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    double lost = 0.0;
    for (int i = 0; i < 40'000;) {
      const int merged = i < 10'000 ? 1 + static_cast<int>(random() % 9) : 1;
      double mean = 0.0;
      for (int k = 0; k < merged; ++k, ++i) {
        const double t = i * period;
        mean += ((t < 10 ? 20 * kDegree * (1 + std::cos(t / 10 * std::numbers::pi)) : 0.0) +
                 noise * normal(random)) /
                merged;
      }
      filter.in.sequence = static_cast<std::uint64_t>(i);
      filter.in.dt_s = merged * period;
      filter.in.averaged_s = merged > 1 ? filter.in.dt_s : 0.0;
      lost += (filter.step({mean}).denoised_radps[0] - mean) * filter.in.dt_s;
    }
    EXPECT_LT(std::abs(lost), 0.001 * kDegree) << "seed " << seed;
  }
}

// A rule that sees the current innovation in its covariance gives a large one less gain: in noise of skewness
// g the plain filter stands where K E[v] = K E[v^3] / (N C), off by -g sigma / N. The gain of the average of
// what the rule believes does not see it.
TEST(SkewedNoise, ShiftsThePlainRulesByItsSkewnessAndASteadyGainDoesNot) {
  constexpr int kLength = 400'000, kFrom = 100'000;
  std::mt19937_64 random(9);
  std::gamma_distribution<double> gamma(4.0, 0.5);  // mean 2, deviation 1, skewness 1
  std::vector<double> measured(kLength);
  for (double& rate : measured) rate = gamma(random);
  const auto offset = [&](const char* rule, bool plain) {
    ifog::FilterSettings settings = told(1e-5);
    if (plain) settings.plain = true;
    settings.rule = rule;
    const Filtered got = run(settings, measured);
    double sum = 0.0;
    for (int i = kFrom; i < kLength; ++i) sum += got.denoised[static_cast<std::size_t>(i)] - 2.0;
    return sum / (kLength - kFrom);
  };
  const double expected = -1.0 / told(1e-5).window;
  for (const char* rule : {"irwe-akfg", "iae"}) {
    EXPECT_NEAR(offset(rule, true), expected, 0.25 * std::abs(expected)) << rule;
    EXPECT_NEAR(offset(rule, false), 0.0, 0.2 * std::abs(expected)) << rule;
  }
  EXPECT_NEAR(offset("ckf", true), 0.0, 0.2 * std::abs(expected));
}

using Quaternion = std::array<double, 4>;

Quaternion times(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
Quaternion inverse(const Quaternion& a) { return {a[0], -a[1], -a[2], -a[3]}; }
Quaternion turned(double x, double y, double z) {
  const double angle = std::sqrt(x * x + y * y + z * z);
  const double s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  return {std::cos(angle / 2), x * s, y * s, z * s};
}
Quaternion turned(const ifog::Axes& rate, double dt_s) {
  return turned(rate[0] * dt_s, rate[1] * dt_s, rate[2] * dt_s);
}

// Drift, deg/h, that the filter adds to an attitude integrated from its output, 300 s of a motion.
std::array<double, 3> added_drift(const std::function<Quaternion(double envelope, double t)>& attitude,
                                  std::uint64_t seed) {
  constexpr double still = 10.0, moving = 300.0, period = 1e-3;
  const double noise = 0.01 * kDegree / 60 / std::sqrt(period);
  const auto at = [&](double t) -> Quaternion {
    const double inside = std::clamp(std::min(t - still, still + moving - t) / 10.0, 0.0, 1.0);
    return attitude(inside * inside * (3 - 2 * inside), t - still);
  };
  ifog::FilterSettings settings;
  settings.measurement_noise = noise * noise;
  settings.process_noise = 1e-3 * noise * noise / period;
  Fed filter(settings, 3, period);
  Noise normal(seed);
  Quaternion measured{1, 0, 0, 0}, denoised{1, 0, 0, 0}, before = at(0);
  const int length = static_cast<int>((moving + 2 * still) / period);
  for (int i = 1; i < length; ++i) {
    const Quaternion now = at(i * period);
    const Quaternion step = times(inverse(before), now);
    before = now;
    const double sine = std::sqrt(step[1] * step[1] + step[2] * step[2] + step[3] * step[3]);
    const double scale = sine > 0 ? 2 * std::atan2(sine, step[0]) / sine / period : 0.0;
    ifog::Axes rate{};
    for (std::size_t a = 0; a < 3; ++a) rate[a] = scale * step[a + 1] + noise * normal();
    measured = times(measured, turned(rate, period));
    denoised = times(denoised, turned(filter.step(rate).denoised_radps, period));
  }
  const Quaternion apart = times(inverse(measured), denoised);
  const double per_hour = 2 / kDegree * 3600 / moving;
  return {per_hour * apart[1], per_hour * apart[2], per_hour * apart[3]};
}

Quaternion cone(double envelope, double t) {
  const double phase = 2 * std::numbers::pi * 0.1 * t;
  return turned(10 * kDegree * envelope * std::cos(phase), 3 * kDegree * envelope * std::sin(phase), 0);
}

TEST(Coning, AddsNoDrift) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const double drift : added_drift(cone, seed))
      EXPECT_LT(std::abs(drift), 0.001) << "deg/h, seed " << seed;
  }
}

}  // namespace
