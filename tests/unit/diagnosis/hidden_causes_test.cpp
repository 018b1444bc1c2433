// SPDX-License-Identifier: Apache-2.0
// Several captures compared coefficient by coefficient, and what is reported when much stays unexplained.
#include "filters/diagnosis/report/left_out.h"

#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

// Records of 600 blocks of unit white noise, each with a coefficient of its own.
BlockData captures_with(const std::vector<double>& coefficients, std::uint64_t seed) {
  BlockData data = white_with_temperature(600 * coefficients.size(), seed);
  data.grid.records.clear();
  for (std::size_t r = 0; r < coefficients.size(); ++r) {
    data.grid.records.push_back({600 * r, 600 * (r + 1)});
    for (std::size_t b = 600 * r; b < 600 * (r + 1); ++b)
      data.grid.error[static_cast<Eigen::Index>(b)] += coefficients[r] * data.channels[0].values[b];
  }
  return data;
}

std::optional<DeniedEffects> denied(const BlockData& data, const std::vector<Form>& forms) {
  std::vector<Candidate> effects;
  for (const Form form : forms) effects.push_back(candidate_of(form));
  return denied_by_a_capture(data, effects, {});
}

// In white noise the share is what the slopes of the captures by themselves are to each other.
TEST(PredictedCapture, WhereTheChannelOnlyRanAlongNothingOfThePredictionIsThere) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const BlockData data = captures_with({0.5, 0.0}, seed);
    const auto found = denied(data, {Form::kLinear});
    ASSERT_TRUE(found) << seed;
    EXPECT_EQ(found->effects, (std::vector<std::size_t>{0}));
    if (found->record == 0) continue;  // nothing was predicted, and much is seen
    EXPECT_NEAR(found->share, 0.0, 5.0 * found->share_error) << seed;
  }
}

TEST(PredictedCapture, WhatIsThereInAllOfThemOrWasTriedInOneIsNotDenied) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    EXPECT_FALSE(denied(captures_with({0.5, 0.5, 0.5}, seed), {Form::kLinear})) << seed;
    EXPECT_FALSE(denied(captures_with({0.5, 0.4}, seed), {Form::kLinear})) << seed;
    EXPECT_FALSE(denied(captures_with({0.5}, seed), {Form::kLinear})) << seed;
    BlockData still = captures_with({0.5, 0.0}, seed);
    for (std::size_t b = 600; b < 1200; ++b) still.channels[0].values[b] = 25.0;
    EXPECT_FALSE(denied(still, {Form::kLinear})) << seed;
  }
}

// A square whose turning point lies in the second capture makes a slope of the first one alone.
TEST(PredictedCapture, ALawThatIsSeenInOneCaptureOnlyThoughAsMuchMovedIsDenied) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    BlockData data = captures_with({0.5, 0.0}, seed);
    for (std::size_t b = 600; b < 1200; ++b) data.channels[0].values[b] += 30.0;
    const auto found = denied(data, {Form::kLinear, Form::kQuadratic});
    ASSERT_TRUE(found) << seed;
    EXPECT_EQ(found->effects, (std::vector<std::size_t>{0, 1})) << "one law of two effects";
  }
}

struct Rows {
  std::vector<double> time_s, rate, temperature;
};

// An hour at 1 Hz; `swing` of the temperature, rad/s per kelvin.
Rows capture_of(double coefficient, double swing, std::uint64_t seed) {
  Rows rows;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 3600; ++i) {
    rows.time_s.push_back(i);
    rows.temperature.push_back(25.0 +
                               swing * std::sin(2.0 * M_PI * i / (900.0 + 37.0 * static_cast<double>(seed))));
    rows.rate.push_back(1e-6 * normal(random) + coefficient * (rows.temperature.back() - 25.0));
  }
  return rows;
}

Record record_of(const Rows& rows, const std::string& name) {
  return made_record(name, rows.time_s, rows.rate, {{"temperature_degC", rows.temperature}});
}

bool said(const Diagnosis& diagnosis, const std::string& part) {
  for (const std::string& remark : diagnosis.remarks)
    if (remark.find(part) != std::string::npos) return true;
  return false;
}

// A square that is flat where the second capture is would do for both together.
TEST(Diagnose, AChannelThatFollowedTheCauseInOneCaptureIsNotSubtracted) {
  const Rows followed = capture_of(4e-7, 6.0, 1);
  Rows alone = capture_of(0.0, 6.0, 2);
  for (double& temperature : alone.temperature) temperature += 8.0;
  const Diagnosis found = diagnose({record_of(followed, "first"), record_of(alone, "second")}, {});
  for (const FoundEffect& each : found.effects) EXPECT_NE(each.effect.channel, "temperature_degC");
  EXPECT_TRUE(said(found, "is no effect of this channel but of something that ran with it"));
}

TEST(HiddenCauses, DeniedEffectsAreNamedWithTheCaptureThatDeniesThem) {
  Effect linear, square;
  linear.form = "linear";
  square.form = "quadratic";
  linear.channel = square.channel = "laser_mA";
  const std::vector<Record> records = {record_of({}, "first"), record_of({}, "second")};
  const std::string said = denied_in_words({linear, square}, {{0, 1}, 1, 0.02, 0.05}, records);
  EXPECT_EQ(said.find("linear of laser_mA and quadratic of laser_mA: of what the other captures predict "
                      "0.02 ± 0.05 is there in second"),
            0U)
      << said;
  EXPECT_NE(
      denied_in_words({linear}, {{0}, 1, std::nan(""), 0.0}, records).find("nothing of it is seen in second"),
      std::string::npos);
}

TEST(HiddenCauses, AClaimBesideMuchThatIsUnexplainedAsksForASecondCapture) {
  Diagnosis diagnosis;
  diagnosis.effects.resize(1);
  diagnosis.unexplained.fraction = 0.51;
  EXPECT_EQ(unexplained_despite_claims(diagnosis, 1), "") << "a line is no channel's";
  diagnosis.effects[0].effect.channel = "temperature_degC";
  EXPECT_NE(unexplained_despite_claims(diagnosis, 1).find("51 %"), std::string::npos);
  EXPECT_NE(unexplained_despite_claims(diagnosis, 1).find("second capture"), std::string::npos);
  EXPECT_EQ(unexplained_despite_claims(diagnosis, 2).find("second capture"), std::string::npos);
  diagnosis.unexplained.fraction = 0.12;
  EXPECT_EQ(unexplained_despite_claims(diagnosis, 1), "");
}

}  // namespace
}  // namespace ifog
