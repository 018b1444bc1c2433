// SPDX-License-Identifier: Apache-2.0
// The room `report`: what was found, as a person and a model file are told.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/report/before_and_after.h"
#include "filters/diagnosis/report/findings.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/diagnosis/report/written_model.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

Effect linear_in_temperature(double coefficient) {
  Effect effect;
  effect.form = "linear";
  effect.channel = "temperature_degC";
  effect.reference = 25.0;
  effect.parameters = {{"coefficient", coefficient, 0.1, "rad/s/K"}};
  return effect;
}

// A correction that is known exactly: what is judged is the part that was not fitted, before and after.
TEST(HeldOutPart, JudgesWhatWasNotFitted) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> time, rate, temperature, noise;
  for (int i = 0; i < 4000; ++i) {
    time.push_back(0.1 * i);
    temperature.push_back(25.0 + 5.0 * std::sin(2.0 * M_PI * i / 900.0));
    noise.push_back(normal(random));
    rate.push_back(noise.back() + 2.0 * (temperature.back() - 25.0));
  }
  Record record;
  record.time_s = time;
  record.rate_radps = rate;
  record.channels = {{"temperature_degC", temperature}};
  Diagnosis diagnosis;
  diagnosis.sample_rate_hz = 10.0;
  diagnosis.effects.resize(1);
  diagnosis.effects[0].effect = linear_in_temperature(2.0);
  diagnosis.covariance = {0.01};
  judge({record}, {0.0, 0.5}, diagnosis);
  const std::vector<double> later(noise.begin() + 2000, noise.end());
  EXPECT_NEAR(diagnosis.after.at("residual_rms_radps"), std::sqrt(variance_of(later)), 1e-3);
  EXPECT_NEAR(diagnosis.before.at("residual_rms_radps"), std::sqrt(1.0 + 50.0), 0.5);
}

TEST(BeforeAndAfter, AreTheFiguresOfTheErrorAndTheLargerOfTheWrittenAndTheHeldOutOne) {
  for (const double written : {0.5, 2.0}) {
    std::vector<EvenError> errors(1);
    for (int i = 0; i < 500; ++i) {
      const double sign = i % 2 ? 1.0 : -1.0;
      errors[0].before.own().push_back(3.0 * sign);
      errors[0].held_out.own().push_back(sign);
      errors[0].written.own().push_back(written * sign);
      errors[0].after.own().push_back(0.0);
    }
    Diagnosis diagnosis;
    KnownFigures known(4);
    KnownAngles angles;
    write_before_and_after(errors, 1.0, known, angles, diagnosis);
    EXPECT_DOUBLE_EQ(diagnosis.before.at("residual_rms_radps"), 3.0);
    EXPECT_DOUBLE_EQ(diagnosis.after.at("residual_rms_radps"), std::max(1.0, written));
  }
}

// A cubic scale factor beside a bias: z = w + b + s w^3. Online z - b is not known to be w; counted from the
// bias the correction leaves that bias and nothing else, which is the closed form of what the daemon solves.
TEST(WrittenModel, CountsRatesFromTheBiasThatStays) {
  constexpr double kBias = 0.02, kCubic = 0.01;
  std::vector<double> time, rate, reference;
  for (int i = 0; i < 400; ++i) {
    time.push_back(i);
    reference.push_back(2.5 * std::sin(0.05 * i));
    rate.push_back(reference.back() + kBias + kCubic * std::pow(reference.back(), 3));
  }
  Record record;
  record.time_s = time;
  record.rate_radps = rate;
  record.reference_radps = reference;
  Diagnosis diagnosis;
  diagnosis.effects.resize(1);
  Effect& effect = diagnosis.effects[0].effect;
  effect.form = "cubic";
  effect.channel = "reference_rate_radps";
  effect.parameters = {{"coefficient", kCubic, 1e-6, ""}};
  diagnosis.covariance = {1e-12};
  diagnosis.ranges = {{"reference_rate_radps", -2.6, 2.6}};
  std::vector<EvenError> errors(1);
  errors[0].after.own().assign(400, kBias);
  run_written_model({record}, diagnosis, 1.0, errors);
  EXPECT_GT(std::sqrt(variance_of(errors[0].written)), 1e-3);
  count_rates_from_the_bias(errors, diagnosis.effects);
  EXPECT_NEAR(effect.reference, kBias, 1e-15);
  run_written_model({record}, diagnosis, 1.0, errors);
  for (const double left : errors[0].written) EXPECT_NEAR(left, kBias, 1e-9);
}

TEST(WrittenModel, TheEffectThatHarmsIsTheOneWithoutWhichLeastIsLeft) {
  std::vector<double> time, rate, temperature, supply;
  for (int i = 0; i < 4000; ++i) {
    time.push_back(i);
    temperature.push_back(25.0 + 5.0 * std::sin(0.01 * i));
    supply.push_back(12.0 + std::sin(0.017 * i));
    rate.push_back(1e-3 * (temperature.back() - 25.0));
  }
  Record record;
  record.time_s = time;
  record.rate_radps = rate;
  record.channels = {{"temperature_degC", temperature}, {"supply_V", supply}};
  Diagnosis diagnosis;
  diagnosis.effects.resize(2);
  diagnosis.effects[0].effect = linear_in_temperature(1e-3);
  diagnosis.effects[1].effect = linear_in_temperature(1e-3);
  diagnosis.effects[1].effect.channel = "supply_V";
  diagnosis.effects[1].effect.reference = 12.0;
  diagnosis.covariance = {1e-12, 0.0, 0.0, 1e-12};
  std::vector<EvenError> errors(1);
  run_written_model({record}, diagnosis, 1.0, errors);
  EXPECT_EQ(most_harmful_effect({record}, diagnosis, 2, 1.0, errors), std::optional<std::size_t>(1));
  diagnosis.effects.pop_back();
  diagnosis.covariance = {1e-12};
  run_written_model({record}, diagnosis, 1.0, errors);
  EXPECT_EQ(most_harmful_effect({record}, diagnosis, 1, 1.0, errors), std::nullopt);
}

// Two effects: the covariance of the joint fit, a time constant's by its logarithm; a line stands alone.
TEST(Findings, CovarianceIsThatOfTheParametersAsTheyAreWritten) {
  FoundEffect lagged;
  lagged.effect.form = "lagged";
  lagged.effect.channel = "temperature_degC";
  lagged.effect.parameters = {{"coefficient", 2.0, 0.1, ""}, {"lag_s", 50.0, 5.0, "s"}};
  FoundEffect line;
  line.effect.form = "line";
  line.effect.parameters = {
      {"cosine", 1.0, 0.2, ""}, {"sine", 1.0, 0.3, ""}, {"frequency_hz", 1.0, 0.4, "Hz"}};
  JointFit joint;
  joint.values = Eigen::Vector3d(0.0, 2.0, 0.0);  // constant, coefficient, logarithm of the lag
  joint.searched = {0};
  joint.covariance = (Eigen::Matrix3d() << 9.0, 0.0, 0.0, 0.0, 0.01, 0.002, 0.0, 0.002, 0.01).finished();
  const std::vector<double> covariance = covariance_of({lagged, line}, joint, 1, 1);
  ASSERT_EQ(covariance.size(), 25U);
  EXPECT_NEAR(covariance[0], 0.01, 1e-15);
  EXPECT_NEAR(covariance[1], 50.0 * 0.002, 1e-15);
  EXPECT_NEAR(covariance[6], 2500.0 * 0.01, 1e-12);
  EXPECT_NEAR(covariance[2 * 5 + 2], 0.04, 1e-15);
  EXPECT_NEAR(covariance[4 * 5 + 4], 0.16, 1e-15);
  EXPECT_EQ(covariance[2], 0.0);
  const BlockData data = white_with_temperature(300, 4);
  const std::vector<ChannelRange> ranges = ranges_of(data, {lagged, line});
  ASSERT_EQ(ranges.size(), 1U);
  EXPECT_EQ(ranges[0].low, data.channels[0].low);
}

// A constant that is off by sigma: after the alignment nothing of it is left; a slope that goes on is.
TEST(Prediction, OfTheLongestRecordLeavesOutAlignedBias) {
  std::vector<double> time, rate;
  for (int i = 0; i < 1000; ++i) {
    time.push_back(i);
    rate.push_back(i % 2 ? 1.0 : -1.0);
  }
  Record longest;
  longest.time_s = time;
  longest.rate_radps = rate;
  Record shorter = longest;
  shorter.time_s = shorter.time_s.first(100);
  shorter.rate_radps = shorter.rate_radps.first(100);
  Diagnosis diagnosis;
  EXPECT_EQ(predict_like_longest(diagnosis, {shorter, longest}).aligned_s, 99.9);
  EXPECT_EQ(predict_heading(diagnosis, longest, 100.0, {200.0}).sigma_rad[0], 0.0);
  Effect ramp;
  ramp.form = "rate_ramp";
  ramp.parameters = {{"coefficient", 1e-6, 0.0, "rad/s/s"}};
  diagnosis.effects.resize(1);
  diagnosis.effects[0].effect = ramp;
  diagnosis.covariance = {0.0};
  // Bias at 50 s, then 200 s of it growing: 1e-6 (200^2 / 2 + 50 * 200).
  EXPECT_NEAR(predict_heading(diagnosis, longest, 100.0, {200.0}).sigma_rad[0], 0.03, 1e-4);
}

// A transition whose half width is known to a tenth of a degree: how far the heading of a capture is off by
// it is the difference of the angles of two of them, their alignment taken out.
TEST(Prediction, ATransitionsHalfWidthIsInDoubtToo) {
  constexpr double kCoefficient = 1e-5, kMiddle = 27.0, kWidth = 1.5, kDoubt = 0.1;
  std::vector<double> time, rate, temperature;
  for (int i = 0; i < 1000; ++i) {
    time.push_back(i);
    rate.push_back(i % 2 ? 1e-9 : -1e-9);
    temperature.push_back(25.0 + 0.004 * i);
  }
  Record record;
  record.time_s = time;
  record.rate_radps = rate;
  record.channels = {{"temperature_degC", temperature}};
  Diagnosis diagnosis;
  diagnosis.effects.resize(1);
  Effect& effect = diagnosis.effects[0].effect;
  effect.form = "transition";
  effect.channel = "temperature_degC";
  effect.reference = kMiddle;
  effect.parameters = {{"coefficient", kCoefficient, 0.0, "rad/s"}, {"half_width", kWidth, kDoubt, "K"}};
  diagnosis.covariance = {0.0, 0.0, 0.0, kDoubt * kDoubt};
  const auto heading = [&](double width) {
    double bias = 0.0, angle = 0.0;
    for (std::size_t i = 0; i < 700; ++i) {
      const double now = kCoefficient * std::tanh((temperature[i] - kMiddle) / width);
      if (i < 100)
        bias += now / 100.0;
      else
        angle += now - bias;
    }
    return angle;
  };
  const double expected = std::abs(heading(kWidth + 0.5 * kDoubt) - heading(kWidth - 0.5 * kDoubt));
  EXPECT_NEAR(predict_heading(diagnosis, record, 100.0, {600.0}).sigma_rad[0] / expected, 1.0, 0.02);
}

}  // namespace
}  // namespace ifog
