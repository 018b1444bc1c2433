// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramps_out.h"
#include "filters/diagnosis/ramp/ramp.h"
#include "filters/effects/compensator.h"
#include "tests/unit/diagnosis/findings.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kPeriod = 4096.0;  // counts
constexpr double kStep_s = 0.005;
constexpr double kPerCount = 80e-9;     // rad/s of one count a sample
constexpr double kNoise = 2e-7;         // rad/s
constexpr double kNonlinearity = 4e-9;  // rad

struct Capture {
  std::vector<double> time, rate, ramp, temperature;
  std::vector<double> made;  // of the rate, by the ramp's nonlinearity
};

Capture capture(std::uint64_t seed, std::size_t n, double turning, double nonlinearity) {
  test::Noise normal(seed);
  const auto angle = [&](double ramp) { return nonlinearity * std::sin(2.0 * M_PI * ramp / kPeriod); };
  Capture out;
  double position = 100.0, before = angle(position);
  for (std::size_t i = 0; i < n; ++i) {
    position = std::fmod(position + turning / kPerCount, kPeriod);
    const double now = angle(std::floor(position));
    out.time.push_back(kStep_s * static_cast<double>(i));
    out.ramp.push_back(std::floor(position));
    out.temperature.push_back(25.0 + std::sin(static_cast<double>(i) / 500.0));
    out.made.push_back((now - before) / kStep_s);
    out.rate.push_back(turning + kNoise * normal() + out.made.back());
    before = now;
  }
  return out;
}

Record record_of(const Capture& made, const char* name) {
  return made_record(name, made.time, made.rate,
                     {{"temperature_degC", made.temperature}, {"ramp_counts", made.ramp}});
}

TEST(RampsOut, TheRateIsLessWhatTheRampMadeOfIt) {
  const std::vector<Capture> made{capture(1, 30000, 7e-5, kNonlinearity),
                                  capture(2, 20000, 5e-5, kNonlinearity)};
  const WithoutRamps without = take_out_ramps({record_of(made[0], "a"), record_of(made[1], "b")}, 0.01);
  ASSERT_EQ(without.ramps.size(), 1U);
  EXPECT_EQ(without.ramps[0].effect.channel, "ramp_counts");
  ASSERT_EQ(without.records.size(), 2U);
  for (std::size_t r = 0; r < made.size(); ++r) {
    const Record& record = without.records[r];
    ASSERT_EQ(record.channels.size(), 1U);
    EXPECT_EQ(record.channels[0].name, "temperature_degC");
    ASSERT_EQ(record.rate_radps.size(), made[r].rate.size());
    double was = 0.0, left = 0.0;
    for (std::size_t i = 1; i < made[r].rate.size(); ++i) {
      const double taken = made[r].rate[i] - record.rate_radps[i];
      was += std::pow(made[r].made[i], 2);
      left += std::pow(made[r].made[i] - taken, 2);
    }
    EXPECT_LT(left, 0.05 * was) << record.name;
    EXPECT_EQ(record.rate_radps.data(), without.rates[r].data());
  }
}

// As a function of its value, a counter that explains nothing would be given what the rotation makes: it is
// in no record, not even in one in which it did not come round.
TEST(RampsOut, ACounterThatMakesNothingOfTheRateIsLeftOut) {
  const Capture turning = capture(3, 4000, 7e-5, 0.0), still = capture(4, 4000, 0.0, 0.0);
  const std::vector<Record> records{record_of(turning, "a"), record_of(still, "b")};
  const WithoutRamps without = take_out_ramps(records, 0.01);
  EXPECT_TRUE(without.ramps.empty());
  EXPECT_TRUE(without.rates.empty());
  ASSERT_EQ(without.records.size(), 2U);
  for (std::size_t r = 0; r < records.size(); ++r) {
    ASSERT_EQ(without.records[r].channels.size(), 1U) << records[r].name;
    EXPECT_EQ(without.records[r].channels[0].name, "temperature_degC");
    EXPECT_EQ(without.records[r].rate_radps.data(), records[r].rate_radps.data());
  }
}

TEST(RampsOut, WhatDoesNotComeRoundStays) {
  const Capture still = capture(5, 4000, 0.0, 0.0);
  const WithoutRamps without = take_out_ramps({record_of(still, "a")}, 0.01);
  EXPECT_TRUE(without.ramps.empty());
  ASSERT_EQ(without.records.size(), 1U);
  EXPECT_EQ(without.records[0].channels.size(), 2U);
  EXPECT_TRUE(take_out_ramps({}, 0.01).records.empty());
}

// Rotation put into the rate and, as the loop would, into the ramp's slope comes out with its gain and phase,
// from a stalled ramp to many wraps a sample.
TEST(Ramp, TheCorrectionIsTransparentToRotation) {
  const Capture made = capture(6, 40000, 5.4e-5, kNonlinearity);
  const auto fit = fit_ramp({record_of(made, "a")}, "ramp_counts", 0.01);
  ASSERT_TRUE(fit.has_value());
  Model model;
  model.effects = {fit->found.effect};
  const auto compensated = [&](const std::vector<double>* rotation) {
    Compensator compensator(model, {""});
    std::vector<double> left;
    double position = 500.0;
    for (std::size_t i = 0; i < 8000; ++i) {
      const double w = rotation != nullptr ? (*rotation)[i] : 0.0;
      position += w / kPerCount;
      position -= kPeriod * std::floor(position / kPeriod);
      CompensatorInput in;
      in.dt_s = kStep_s;
      in.rate_radps[0] = w;
      const std::vector<double> channel = {std::floor(position)};
      in.channels = channel;
      CompensatorOutput out;
      compensator.step(in, out);
      left.push_back(out.compensated_radps[0]);
    }
    return left;
  };
  expect_transparent(compensated, kStep_s, {0.0, 5.4e-5, 2.6e-3, 9.7e-3});
}

}  // namespace
}  // namespace ifog
