// SPDX-License-Identifier: Apache-2.0
// No report says against itself: no figure grows without a word of it, no shares are more than there is, and
// what the daemon makes of the channels as they were logged is what is promised.
#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/diagnosis/report/report.h"
#include "filters/diagnosis/search/search.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

double deviate(std::uint32_t counter, std::uint32_t stream) {
  return gaussian_deviate(counter, stream, 91, 7);
}

// A machine that runs up and down next to a gyro whose bias follows its power, 20 Hz.
struct Shaken {
  std::vector<double> time, rate, accel;

  Shaken() {
    constexpr double kBias = 1e-8, kWhite = 1e-6;
    double power = 0.0;
    for (std::uint32_t i = 0; i < 24000; ++i) {
      const double t = 0.05 * i;
      const double level = 1.5 + std::sin(2.0 * M_PI * t / 170.0) + 0.4 * std::sin(2.0 * M_PI * t / 61.0);
      accel.push_back(level * deviate(i, 1));
      power += -std::expm1(-0.05) * (accel.back() * accel.back() - power);
      time.push_back(t);
      rate.push_back(kBias * power + kWhite * 0.1 * deviate(i, 2));
    }
  }
  void say(double number, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) accel[i] = number;
  }
  [[nodiscard]] Record record() const { return made_record("", time, rate, {{"accel_x_mps2", accel}}); }
};

double of_10s_means(std::span<const double> error) { return std::sqrt(variance_of(means_over(error, 200))); }

// A logger's number for half a minute, which the daemon's compensator gets as it stands.
TEST(ConsistentReport, APlaceholderInTheChannelDoesNotComeOutOfTheCorrection) {
  for (const double number : {9999.0, -999.0}) {
    Shaken s;
    s.say(number, 9000, 9600);
    const Record logged = s.record();
    const Diagnosis found = diagnose({logged}, {});
    ASSERT_FALSE(found.effects.empty());
    EXPECT_EQ(found.effects[0].effect.form, "band_power");
    EXPECT_LT(found.after.at("rms_10s_radps"), 0.7 * found.before.at("rms_10s_radps"));
    Model model;
    add_to_model(found, "", model);
    const double left = of_10s_means(compensated_error(logged, model));
    EXPECT_LT(left, 1.1 * found.after.at("rms_10s_radps")) << number;
    for (const std::string& remark : found.remarks) EXPECT_FALSE(test::has(remark, "grow")) << remark;
  }
}

TEST(ConsistentReport, SharesAreTogetherNoMoreThanTheUnexplainedLeaves) {
  Diagnosis diagnosis;
  diagnosis.effects.resize(3);
  diagnosis.effects[0].variance_explained = 0.6;
  diagnosis.effects[1].variance_explained = 0.3;
  diagnosis.effects[2].variance_explained = 0.5;  // of single samples
  diagnosis.unexplained.fraction = 0.97;
  balance_shares(2, diagnosis);
  EXPECT_NEAR(diagnosis.effects[0].variance_explained, 0.02, 1e-12);
  EXPECT_NEAR(diagnosis.effects[1].variance_explained, 0.01, 1e-12);
  EXPECT_EQ(diagnosis.effects[2].variance_explained, 0.5);
  diagnosis.unexplained.fraction = 0.1;
  balance_shares(2, diagnosis);
  EXPECT_NEAR(diagnosis.effects[0].variance_explained, 0.02, 1e-12) << "what fits is left as it is";
}

// In the judged half a channel acts opposite to the fitted half: the error that grows there is reported, too.
TEST(ConsistentReport, WhatWasKeptBackMayDenyAndThenTheReportSaysSo) {
  std::vector<double> time, rate, channel;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const double t = 0.1 * i;
    time.push_back(t);
    channel.push_back(25.0 + 5.0 * std::sin(2.0 * M_PI * t / 150.0) + 2.0 * std::sin(2.0 * M_PI * t / 37.0));
    rate.push_back((i < 10000 ? 1e-6 : -1e-6) * (channel.back() - 25.0) + 1e-6 * deviate(i, 3));
  }
  DiagnoseOptions options;
  options.fit_to = 0.5;
  const Diagnosis found = diagnose({made_record("", time, rate, {{"temperature_degC", channel}})}, options);
  ASSERT_FALSE(found.effects.empty());
  ASSERT_GT(found.after.at("rms_1s_radps"), 1.5 * found.before.at("rms_1s_radps"));
  const auto told = [](const std::string& remark) {
    return remark.find("on what was kept back to judge") == 0 &&
           remark.find("1 s means grow") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), told));
}

// Twelve seconds of a fibre-optic gyro on a mounting that sways at 14 Hz, 100 Hz, as ten seconds of rest in a recording
// of a hand-held unit: its wander looks like a jump to the search, and chance to the joint fit.
TEST(ConsistentReport, NothingIsClaimedThatItsOwnErrorBarCallsChance) {
  const double phase = 2.0 * M_PI * 0.14, kept = std::exp(-0.05);
  for (std::uint32_t seed = 22; seed <= 29; ++seed) {
    std::vector<double> time, rate;
    double wander = 0.0, sway = 0.0, before = 0.0;
    for (std::uint32_t i = 0; i < 1200; ++i) {
      const double next =
          2.0 * kept * std::cos(phase) * sway - kept * kept * before + gaussian_deviate(i, 1, seed, 5);
      before = std::exchange(sway, next);
      wander += -0.01 * wander + 0.14 * gaussian_deviate(i, 2, seed, 5);
      time.push_back(0.01 * i);
      rate.push_back(1e-5 * (0.3 * sway + wander));
    }
    for (const FoundEffect& each : diagnose({made_record("", time, rate)}, {}).effects)
      EXPECT_LE(each.p_value, 0.01) << each.effect.form << ", seed " << seed;
  }
}

// The promises of a fit, kept in repeated trials: how often intervals hold the truth, and how large the
// heading error of another capture is compared with its prediction.

constexpr std::size_t kSamples = 600;
constexpr double kCoefficient = 0.5;
constexpr double kLag = 60.0;

double gaussian(std::uint32_t counter, std::uint32_t stream, std::uint32_t seed) {
  return gaussian_deviate(counter, stream, seed, 17);
}

// White noise of unit variance at 1 Hz, a walk that overtakes it after a minute, and a slow temperature that
// comes through with a lag.
struct Trial {
  std::vector<double> time, rate, noise, temperature;

  Trial(std::uint32_t seed, double cycles) {
    double walk = 0.0;
    double lagged = 0.0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      walk += 0.03 * gaussian(i, 1, seed);
      time.push_back(i);
      temperature.push_back(25.0 + 10.0 * std::sin(2.0 * M_PI * cycles * i / kSamples));
      const double above = temperature.back() - 25.0;
      lagged = i == 0 ? above : lagged + (1.0 - std::exp(-1.0 / kLag)) * (above - lagged);
      noise.push_back(gaussian(i, 0, seed) + walk);
      rate.push_back(noise.back() + kCoefficient * lagged);
    }
  }

  [[nodiscard]] Record record() const {
    return made_record("trial", time, rate, {{"temperature_degC", temperature}});
  }
};

struct Fitted {
  JointFit joint;
  Diagnosis diagnosis;
};

// What the search leaves when it is right.
Fitted fitted(const Trial& trial) {
  const BlockData data = cut_to_blocks({trial.record()});
  SearchResult found;
  found.chosen.resize(1);
  Candidate& lagged = found.chosen[0].candidate;
  lagged.form = Form::kLagged;
  lagged.channel = 0;
  lagged.time_constant_s = 1.1 * kLag;
  const Columns columns = design(data, {lagged});
  found.noise = fit_noise(data.grid, columns);
  fit_coefficients(data, found);
  Fitted fit;
  fit.joint = settle(data, found);
  write_findings(data, found, fit.joint, "", fit.diagnosis);
  fit.diagnosis.covariance = covariance_of(fit.diagnosis.effects, fit.joint, data.grid, 1);
  fit.diagnosis.ranges = ranges_of(data, fit.diagnosis.effects);
  fit.diagnosis.noise_posterior = fit.joint.noise;
  return fit;
}

// Both promises, on the same fits.
TEST(Uncertainty, IntervalsAndThePredictedHeadingAreAsGoodAsTheySay) {
  constexpr int kTrials = 100;
  constexpr double kAligned = 60.0;
  constexpr double kAfter = 500.0;
  int coefficient = 0;
  int lag = 0;
  double square = 0.0;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const Fitted fit = fitted(Trial(seed, 1.5));
    const std::vector<ModelParameter>& p = fit.diagnosis.effects[0].effect.parameters;
    coefficient += std::abs(p[0].value - kCoefficient) < 1.96 * p[0].std_error;
    lag += std::abs(p[1].value - kLag) < 1.96 * p[1].std_error;
    const Trial next(seed + 1000, 0.8);
    const HeadingPrediction predicted = predict_heading(fit.diagnosis, next.record(), kAligned, {kAfter});
    // The correction by a loop of our own.
    double lagged = next.temperature[0] - 25.0;
    double bias = 0.0;
    double angle = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kAligned + kAfter); ++i) {
      if (i > 0) lagged += (1.0 - std::exp(-1.0 / p[1].value)) * (next.temperature[i] - 25.0 - lagged);
      const double left = next.rate[i] - p[0].value * lagged;
      if (static_cast<double>(i) < kAligned)
        bias += left / kAligned;
      else
        angle += left - bias;
    }
    square += angle * angle / (predicted.sigma_rad[0] * predicted.sigma_rad[0]) / kTrials;
  }
  // Binomial, 100 trials at 95 %: 95, standard deviation 2.2.
  EXPECT_GE(coefficient, 88);
  EXPECT_LE(coefficient, 99);
  EXPECT_GE(lag, 88);
  EXPECT_LE(lag, 99);
  // Mean of 100 squares of unit normals: 1, standard deviation 0.14.
  EXPECT_GT(square, 0.65);
  EXPECT_LT(square, 1.4);
}

// The noise that a diagnosis reports besides the effects.

// Two hours of one a second. White noise of unit N, and a bias of sigma that forgets in 36 s; or none.
Diagnosis diagnosed(double sigma) {
  constexpr double kForgets_s = 36.0;
  const double kept = std::exp(-1.0 / kForgets_s), driven = std::sqrt(1.0 - kept * kept);
  std::vector<double> time, rate;
  double bias = 0.0;
  for (std::uint32_t i = 0; i < 7200; ++i) {
    bias = kept * bias + driven * sigma * gaussian_deviate(i, 1, 17, 8);
    time.push_back(i);
    rate.push_back(1e-6 * (bias + gaussian_deviate(i, 2, 17, 8)));
  }
  return diagnose({made_record("", time, rate)}, {});
}

TEST(ReportedNoise, ABiasThatComesBackIsThereWithItsTime) {
  const Diagnosis found = diagnosed(1.5);
  ASSERT_TRUE(found.markov.has_value());
  EXPECT_TRUE(found.markov->present);
  EXPECT_GT(36.0, found.markov->lower_s);
  EXPECT_LT(36.0, found.markov->upper_s);
  EXPECT_NEAR(found.markov->sigma_radps, 1.5e-6, 0.4e-6);
}

TEST(ReportedNoise, WhereNothingComesBackThereIsNone) {
  const Diagnosis found = diagnosed(0.0);
  EXPECT_FALSE(found.markov.has_value() && found.markov->present);
}

// A supply that is switched, twenty samples a second: what is left is the noise, to the sample.
TEST(ReportedNoise, OfAChannelThatStepsIsTheSensorsOwn) {
  std::vector<double> time, rate, supply;
  for (std::uint32_t i = 0; i < 36000; ++i) {
    const double volts = 12.0 + 0.4 * gaussian_deviate(i / 740, 3, 17, 8);
    time.push_back(0.05 * i);
    rate.push_back(1e-6 * gaussian_deviate(i, 4, 17, 8) + 1e-4 * (volts - 12.0));
    supply.push_back(volts + 1e-4 * gaussian_deviate(i, 5, 17, 8));
  }
  const Diagnosis found = diagnose({made_record("", time, rate, {{"supply_V", supply}})}, {});
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].effect.channel, "supply_V");
  EXPECT_NEAR(found.after.at("residual_rms_radps"), 1e-6, 0.02e-6);
  EXPECT_NEAR(found.after.at("rms_1s_radps"), 1e-6 / std::sqrt(20.0), 0.05e-6 / std::sqrt(20.0));
  EXPECT_FALSE(found.noise.Q.has_value());
  ASSERT_TRUE(found.noise.N.has_value());
  EXPECT_NEAR(*found.noise.N, 1e-6 * std::sqrt(0.05), 0.05e-6 * std::sqrt(0.05));
}

}  // namespace
}  // namespace ifog
