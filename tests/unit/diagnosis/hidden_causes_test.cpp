// SPDX-License-Identifier: Apache-2.0
// Several captures compared coefficient by coefficient, and what is reported when much stays unexplained.
#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/report/report.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

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
  test::Noise normal(seed);
  for (int i = 0; i < 3600; ++i) {
    rows.time_s.push_back(i);
    rows.temperature.push_back(25.0 +
                               swing * std::sin(2.0 * M_PI * i / (900.0 + 37.0 * static_cast<double>(seed))));
    rows.rate.push_back(1e-6 * normal() + coefficient * (rows.temperature.back() - 25.0));
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

TEST(HiddenCauses, AClaimBesideMuchThatIsUnexplainedAsksForASecondCapture) {
  Diagnosis diagnosis;
  diagnosis.effects.resize(1);
  diagnosis.unexplained.fraction = 0.51;
  EXPECT_EQ(unexplained_despite_claims(diagnosis, 1), "") << "a line is no channel's";
  diagnosis.effects[0].effect.channel = "temperature_degC";
  EXPECT_TRUE(test::has(unexplained_despite_claims(diagnosis, 1), "51 %"));
  EXPECT_TRUE(test::has(unexplained_despite_claims(diagnosis, 1), "second capture"));
  EXPECT_FALSE(test::has(unexplained_despite_claims(diagnosis, 2), "second capture"));
  diagnosis.unexplained.fraction = 0.12;
  EXPECT_EQ(unexplained_despite_claims(diagnosis, 1), "");
}

// Effects found on a structure that sways.

constexpr double kTurn = 2.0 * std::numbers::pi;

// Rate of a structure whose angle is a damped oscillator's, as means over steps.
class Tower {
 public:
  Tower(double frequency_hz, double quality, double angle, std::uint64_t seed)
      : random_(seed), angle_(angle), frequency_hz_(frequency_hz), quality_(quality) {
    state_ = angle_ * deviate();
  }
  double turned_in(double dt) {
    const double before = state_.real();
    const double left = std::exp(-dt * std::numbers::pi * frequency_hz_ / quality_);
    state_ = state_ * std::polar(left, kTurn * frequency_hz_ * dt) +
             angle_ * std::sqrt(1.0 - left * left) * deviate();
    return (state_.real() - before) / dt;
  }

 private:
  // The order of two draws in one expression is the compiler's, and another one's on aarch64.
  std::complex<double> deviate() {
    const double imaginary = normal_(random_), real = normal_(random_);
    return {real, imaginary};
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double angle_, frequency_hz_, quality_;
  std::complex<double> state_;
};

struct Capture {
  std::vector<double> time_s, rate, temperature;

  [[nodiscard]] Record record() const {
    return made_record("capture", time_s, rate, {{"temperature_degC", temperature}});
  }
  [[nodiscard]] Diagnosis diagnosed() const { return diagnose({record()}, {}); }
};

constexpr double kWhite = 1e-6;  // rad/s, of a sample
constexpr double kSample_s = 0.2;

Capture on_a_tower(std::uint64_t seed, double angle) {
  Capture capture;
  Tower tower(0.54, 30.0, angle, seed);
  test::Noise normal(300 + seed);
  for (std::size_t i = 0; i < 36000; ++i) {
    const double t = kSample_s * static_cast<double>(i);
    capture.time_s.push_back(t);
    capture.rate.push_back(tower.turned_in(kSample_s) + kWhite * normal());
    capture.temperature.push_back(28.0 + 6.0 * std::sin(kTurn * t / 3100.0) +
                                  2.0 * std::sin(kTurn * t / 700.0 + 1.0));
  }
  return capture;
}

// The derivative at so many times the error that white noise alone would leave of it.
void add_rate_effect(Capture& capture, double floors) {
  const std::size_t n = capture.rate.size();
  std::vector<double> slope(n, 0.0);
  double square = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    slope[i] = (capture.temperature[i] - capture.temperature[i - 1]) / kSample_s;
    square += slope[i] * slope[i];
  }
  for (std::size_t i = 0; i < n; ++i) capture.rate[i] += floors * kWhite / std::sqrt(square) * slope[i];
}

// The angle is such that the rate it makes is some thirty times the white noise of means of a second.
constexpr double kSway = 30.0 * kWhite * 0.447 / (kTurn * 0.54);

TEST(Diagnose, FindsARateOfTheTemperatureOnATowerThatSways) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    Capture capture = on_a_tower(seed, kSway);
    EXPECT_TRUE(capture.diagnosed().effects.empty()) << seed;
    add_rate_effect(capture, 14.0);
    const Diagnosis found = capture.diagnosed();
    ASSERT_EQ(found.effects.size(), 1U) << seed;
    EXPECT_EQ(found.effects[0].effect.form, "rate") << seed;
    EXPECT_EQ(found.effects[0].effect.channel, "temperature_degC") << seed;
  }
}

// A thermostat's cycle is as narrow as a resonance. What the channel explains is the channel's.
TEST(Diagnose, AThermostatsCycleIsNotTakenForAResonance) {
  Capture capture = on_a_tower(21, 0.0);
  Tower thermostat(1.0 / 60.0, 12.0, 1.0, 22);
  double cycle = 0.0;
  for (std::size_t i = 0; i < capture.rate.size(); ++i) {
    cycle += 0.05 * thermostat.turned_in(kSample_s) * kSample_s;
    capture.temperature[i] = 28.0 + cycle;
    capture.rate[i] += 10.0 * kWhite * cycle;
  }
  const Diagnosis found = capture.diagnosed();
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].effect.form, "linear");
  EXPECT_NEAR(found.effects[0].effect.parameters[0].value, 10.0 * kWhite, 1.5 * kWhite);
}

}  // namespace
}  // namespace ifog
