// SPDX-License-Identifier: Apache-2.0
// No report says against itself: no figure grows without a word of it, no shares are more than there is, and
// what the daemon makes of the channels as they were logged is what is promised.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/report/before_and_after.h"
#include "tests/unit/diagnosis/made_capture.h"

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
    for (const std::string& remark : found.remarks)
      EXPECT_EQ(remark.find("grow"), std::string::npos) << remark;
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

TEST(ConsistentReport, EveryFigureThatGrowsIsTold) {
  Diagnosis diagnosis;
  diagnosis.sample_rate_hz = 10.0;
  diagnosis.effects.resize(1);
  diagnosis.before = {{"residual_rms_radps", 1.0}, {"rms_1s_radps", 0.5}, {"rms_100s_radps", 0.1}};
  diagnosis.after = {{"residual_rms_radps", 1.0}, {"rms_1s_radps", 0.4}, {"rms_100s_radps", 0.2}};
  const std::string few = grown_in_words(diagnosis, 50000.0);
  EXPECT_EQ(few.find("100 s means grow 2 times, but there are 50 of them"), 0U) << few;
  diagnosis.after["residual_rms_radps"] = 1.5;
  const std::string many = grown_in_words(diagnosis, 50000.0);
  EXPECT_EQ(many.find("single samples grow 1.5 times; 100 s means grow 2 times"), 0U) << many;
  EXPECT_NE(many.find("that is no chance"), std::string::npos) << many;
  diagnosis.after = diagnosis.before;
  EXPECT_EQ(grown_in_words(diagnosis, 50000.0), "");
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
  Record record;
  record.time_s = time;
  record.rate_radps = rate;
  record.channels = {{"temperature_degC", channel}};
  DiagnoseOptions options;
  options.fit_to = 0.5;
  const Diagnosis found = diagnose({record}, options);
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

}  // namespace
}  // namespace ifog
