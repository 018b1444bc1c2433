// SPDX-License-Identifier: Apache-2.0
// What a model gains on a recording: the effect that was put in, and the error it leaves.
#include "tests/unit/test.h"
#include "tools/ifog/field/recorded.h"

namespace ifog::tools {
namespace {

constexpr double kCoefficient = 2e-7;  // rad/s/degC

Recorded recorded_hour(double coefficient) {
  constexpr double kPeriod_s = 0.1;
  ifog::test::Noise normal(5);
  Capture capture;
  capture.axes = {""};
  capture.rate_radps.resize(1);
  capture.reference_rate_radps.resize(1);
  capture.channels = {{"temperature_degC", {}}};
  for (int i = 0; i < 36000; ++i) {
    const double t = i * kPeriod_s, temperature = 27.0 + 3.0 * std::sin(2.0 * std::numbers::pi * t / 900.0);
    capture.time_s.push_back(t);
    capture.channels[0].values.push_back(temperature);
    capture.rate_radps[0].push_back(5e-5 + coefficient * (temperature - 25.0) + 1e-6 * normal());
  }
  return {LongCapture(long_table(capture), "hour"), kPeriod_s, {{{0, 36000}}, 36000, 0, 0, {}, {}}};
}

Model linear(double coefficient) {
  Model out;
  Effect effect;
  effect.form = "linear";
  effect.channel = "temperature_degC";
  effect.reference = 25.0;
  effect.parameters = {{"coefficient", coefficient, 1e-9, "rad/s/degC"}};
  out.effects = {effect};
  out.ranges = {{"temperature_degC", 24.0, 30.0}};
  return out;
}

TEST(WeighModels, TheRightCorrectionIsAllThere) {
  const std::vector<AxisGain> gain =
      weigh_models(recorded_hour(kCoefficient), Model{}, linear(kCoefficient), 12000);
  ASSERT_EQ(gain.size(), 1U);
  EXPECT_NEAR(gain[0].kept.share, 1.0, 4.0 * gain[0].kept.share_error);
  EXPECT_EQ(verdict_of(gain), PromiseVerdict::kept);
  EXPECT_NEAR(gain[0].kept.seconds, 2400.0, 1e-6);
  // 10 s means: a sine of 3 degC before, white noise over the root of a hundred samples after.
  EXPECT_NEAR(gain[0].kept.errors[1].before_radps, kCoefficient * 3.0 / std::sqrt(2.0),
              0.1 * kCoefficient * 3.0);
  EXPECT_NEAR(gain[0].kept.errors[1].after_radps, 1e-7, 2e-8);
}

TEST(WeighModels, TwiceTheRightOneIsInPartAndThreeTimesBroken) {
  // Of a correction twice as large a half is there; of one half as large all, twice over.
  EXPECT_EQ(verdict_of(weigh_models(recorded_hour(kCoefficient), Model{}, linear(1.4 * kCoefficient), 0)),
            PromiseVerdict::in_part);
  EXPECT_EQ(verdict_of(weigh_models(recorded_hour(kCoefficient), Model{}, linear(3.0 * kCoefficient), 0)),
            PromiseVerdict::broken);
  EXPECT_EQ(verdict_of(weigh_models(recorded_hour(0.0), Model{}, linear(kCoefficient), 0)),
            PromiseVerdict::broken);
}

TEST(WeighModels, TheSameModelWeighsNothing) {
  EXPECT_TRUE(weigh_models(recorded_hour(kCoefficient), linear(1e-7), linear(1e-7), 0).empty());
  EXPECT_EQ(verdict_of({}), PromiseVerdict::open);
}

}  // namespace
}  // namespace ifog::tools
