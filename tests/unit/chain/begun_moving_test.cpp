// SPDX-License-Identifier: Apache-2.0
// A filter may begin anywhere in a motion: whatever the rate, the swing and what is known of the noise, from
// the first sample on the published rate is as near the truth as its variance says, and not further from it
// than the raw one. The truth is the simulated one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "filters/chain/signal_chain.h"
#include "tests/unit/sanitized.h"

namespace ifog {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRandomWalk = 0.005 * kDegree / 60.0;  // rad/√s
// Over any so many samples the normalised error squared is on average less than that: of noise alone the mean
// of 64 squares is beyond 2.2 once in 10^7. A motion that begins slowly adds what is needed to notice it.
constexpr std::size_t kSamples = 64;
constexpr double kMost = 16.0;
constexpr unsigned kSeeds = 5;

double noise_of(double rate_hz) { return kRandomWalk * kRandomWalk * rate_hz; }

ChainSettings settings_of(double rate_hz, bool told) {
  ChainSettings out;
  out.facts.nominal_rate_hz = rate_hz;
  out.axes = {""};
  if (told) {
    out.filter.process_noise = 1e-16;
    out.filter.measurement_noise = noise_of(rate_hz);
  }
  return out;
}

// A ship: it rolls with a period of ten seconds, and something quicker.
std::function<double(double)> rolling(double amplitude_radps) {
  return [amplitude_radps](double t) {
    return amplitude_radps *
           (std::cos(0.2 * std::numbers::pi * t + 0.3) + 0.2 * std::cos(0.26 * std::numbers::pi * t));
  };
}

struct Errors {
  std::vector<double> published, raw, normalised;  // the last one squared
  std::uint64_t manoeuvres = 0;
};

class Simulated {
 public:
  Simulated(const ChainSettings& settings, unsigned seed)
      : period_s_(1.0 / settings.facts.nominal_rate_hz),
        noise_(std::sqrt(noise_of(settings.facts.nominal_rate_hz))),
        random_(seed),
        chain_(std::make_unique<ChainParts>(settings)) {}

  void go(double seconds, const std::function<double(double)>& motion) {
    for (const double until = time_s_ + seconds; time_s_ < until; time_s_ += period_s_) {
      const double truth = motion(time_s_),
                   measured = truth + noise_ * normal_(random_) + std::exchange(blow_, 0.0);
      Increment in;
      in.sequence = sequence_++;
      in.samples = 1;
      in.valid_axes = 1;
      in.dt_s = period_s_ + std::exchange(gap_s_, 0.0);
      in.covered_s[0] = period_s_;
      in.rate_radps[0] = measured;
      in.delta_theta_rad[0] = measured * period_s_;
      if (in.dt_s > 1.5 * period_s_) in.flags |= kGapBefore;
      ChainOutput out;
      chain_.process(in, out);
      const double error = out.estimate.denoised_radps[0] - truth;
      errors.published.push_back(error);
      errors.raw.push_back(measured - truth);
      errors.normalised.push_back(error * error / out.estimate.variance_rad2ps2[0]);
    }
    errors.manoeuvres = chain_.health().manoeuvres;
  }
  void add_once(double rate) { blow_ = rate; }
  void skip(double seconds) {
    time_s_ += seconds;
    gap_s_ = seconds;
  }
  void reload(const ChainSettings& settings) { chain_.swap(std::make_unique<ChainParts>(settings)); }

  Errors errors;

 private:
  double period_s_, noise_, time_s_ = 0.0, gap_s_ = 0.0, blow_ = 0.0;
  std::uint64_t sequence_ = 0;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  SignalChain chain_;
};

double worst(const std::vector<double>& normalised) {
  double sum = 0.0, most = 0.0;
  for (std::size_t i = 0; i < normalised.size(); ++i) {
    sum += normalised[i] - (i >= kSamples ? normalised[i - kSamples] : 0.0);
    most = std::max(most, sum / kSamples);
  }
  return most;
}

double rms(const std::vector<double>& errors, std::size_t from) {
  double sum = 0.0;
  for (std::size_t i = from; i < errors.size(); ++i) sum += errors[i] * errors[i];
  return std::sqrt(sum / static_cast<double>(errors.size() - from));
}

// 0.01 to 10 °/s.
const std::vector<double> kAmplitudes{0.01, 0.1, 1.0, 10.0};
const std::vector<double> kRates{10.0, 25.0, 50.0, 100.0, 200.0};

TEST(BegunMoving, EveryRateAndSwingIsFollowedFromTheFirstSample) {
  for (const bool told : {true, false})
    for (const double rate_hz : kRates)
      for (const double amplitude : kAmplitudes) {
        SCOPED_TRACE((told ? "told, " : "untold, ") + std::to_string(rate_hz) + " Hz, " +
                     std::to_string(amplitude) + " °/s");
        for (unsigned seed = 1; seed <= test::fewer(kSeeds, 1U); ++seed) {
          Simulated run(settings_of(rate_hz, told), seed);
          run.go(120.0, rolling(amplitude * kDegree));
          EXPECT_LT(worst(run.errors.normalised), kMost) << seed;
          const auto minute = static_cast<std::size_t>(60.0 * rate_hz);
          EXPECT_LT(rms(run.errors.published, minute), 1.05 * rms(run.errors.raw, minute));
        }
      }
}

// At rest a beginning is none of a motion.
TEST(BegunMoving, AtRestNothingIsTakenForAManoeuvre) {
  for (const bool told : {true, false})
    for (const double rate_hz : {10.0, 200.0})
      for (unsigned seed = 1; seed <= 200; ++seed) {
        Simulated run(settings_of(rate_hz, told), seed);
        run.go(500.0 / rate_hz, [](double) { return 1e-4; });
        EXPECT_EQ(run.errors.manoeuvres, 0U) << told << " " << rate_hz << " " << seed;
      }
}

// What a mean of all that was measured would leave is nearly reached after the first hundred samples.
TEST(BegunMoving, AtRestLittleIsLostByIt) {
  constexpr int kRecords = 400, kLength = 256;
  std::vector<double> square(kLength), normalised(kLength);
  for (unsigned seed = 1; seed <= kRecords; ++seed) {
    Simulated run(settings_of(100.0, true), seed);
    run.go((kLength - 0.5) / 100.0, [](double) { return 0.0; });
    for (std::size_t i = 0; i < kLength; ++i) {
      square[i] += run.errors.published[i] * run.errors.published[i] / noise_of(100.0) / kRecords;
      normalised[i] += run.errors.normalised[i] / kRecords;
    }
  }
  for (const int n : {16, 32, 64, 128, 256}) {
    EXPECT_LT(square[static_cast<std::size_t>(n - 1)] * n, 2.0) << n;
    EXPECT_LT(normalised[static_cast<std::size_t>(n - 1)], 1.4) << n;
  }
}

// Among the first samples, too.
TEST(BegunMoving, AJumpIsFollowedAndASingleOutlierPassedOver) {
  const double sigma = std::sqrt(noise_of(100.0));
  for (const int at : {24, 40, 60, 100})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const double since = (at - 0.5) / 100.0;
      Simulated jump(settings_of(100.0, true), seed);
      jump.go(3.0, [&](double t) { return t < since ? 0.0 : 20.0 * sigma; });
      for (std::size_t i = static_cast<std::size_t>(at) + 10; i < jump.errors.published.size(); ++i)
        ASSERT_LT(std::abs(jump.errors.published[i]), 6.0 * sigma) << at << " " << seed << " " << i;
      EXPECT_LT(worst(jump.errors.normalised), kMost) << at << " " << seed;
      Simulated outlier(settings_of(100.0, true), seed);
      outlier.go(since, [](double) { return 0.0; });
      outlier.add_once(50.0 * sigma);
      outlier.go(2.0, [](double) { return 0.0; });
      for (std::size_t i = static_cast<std::size_t>(at); i < outlier.errors.published.size(); ++i)
        ASSERT_LT(std::abs(outlier.errors.published[i]), 2.5 * sigma) << at << " " << seed << " " << i;
      EXPECT_EQ(outlier.errors.manoeuvres, 0U) << at << " " << seed;
    }
}

TEST(BegunMoving, AGapAReloadOrAPullingAwayIsFollowedToo) {
  for (const double rate_hz : kRates)
    for (const double amplitude : kAmplitudes) {
      SCOPED_TRACE(std::to_string(rate_hz) + " Hz, " + std::to_string(amplitude) + " °/s");
      const auto motion = rolling(amplitude * kDegree);
      const std::function<double(double)> still = [](double) { return 0.0; };
      for (const bool rests : {false, true}) {
        Simulated gap(settings_of(rate_hz, true), 2);
        gap.go(30.0, rests ? still : motion);
        gap.skip(7.0);
        gap.go(60.0, motion);
        EXPECT_LT(worst(gap.errors.normalised), kMost) << "gap, " << rests;
        Simulated reload(settings_of(rate_hz, true), 3);
        reload.go(30.0, rests ? still : motion);
        reload.reload(settings_of(rate_hz, true));
        reload.go(60.0, motion);
        EXPECT_LT(worst(reload.errors.normalised), kMost) << "reload, " << rests;
      }
      Simulated away(settings_of(rate_hz, true), 4);
      away.go(30.0, [&](double t) { return 20.0 * amplitude * kDegree * std::clamp(t - 0.3, 0.0, 1.0); });
      EXPECT_LT(worst(away.errors.normalised), kMost) << "pulls away";
    }
}

}  // namespace
}  // namespace ifog
