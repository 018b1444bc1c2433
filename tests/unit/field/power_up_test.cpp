// SPDX-License-Identifier: Apache-2.0
// A warm-up counts from power-up, where the recordings say when that was. Oracle: the exponential itself.
#include "tools/ifog/diagnose/power_up.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "drivers/flight/archive.h"
#include "drivers/flight/folder.h"
#include "drivers/transport/clock.h"
#include "tests/unit/own_folder.h"
#include "tools/ifog/field/recorded.h"

namespace ifog::tools {
namespace {

Diagnosis found(double coefficient, double time_constant_s) {
  Diagnosis out;
  FoundEffect other, warm_up;
  other.effect.form = "linear";
  other.effect.parameters = {{"coefficient", 2.0, 0.1, "rad/s/degC"}};
  warm_up.effect.form = "warm_up";
  warm_up.effect.parameters = {{"coefficient", coefficient, 0.3, "rad/s"},
                               {"time_constant_s", time_constant_s, 5.0, "s"}};
  out.effects = {other, warm_up};
  out.covariance = {0.01, 0.002, 0.03, 0.002, 0.09, -0.6, 0.03, -0.6, 25.0};
  return out;
}

TEST(PowerUp, AWarmUpThatWasFoundLaterIsTheSameDrift) {
  constexpr double kTau = 600.0, kBegan = 900.0;
  Diagnosis diagnosis = found(4.0, kTau);
  count_from_power_up(diagnosis, kBegan);
  const Effect& effect = diagnosis.effects[1].effect;
  EXPECT_FALSE(effect.shown_only);
  EXPECT_NE(effect.meaning.find("after power-up"), std::string::npos);
  for (const double t : {0.0, 100.0, 2000.0})
    EXPECT_NEAR(effect.parameters[0].value * std::exp(-(kBegan + t) / kTau), 4.0 * std::exp(-t / kTau),
                1e-12);
  // The drift at the record's start is as well known as before: g' C g of a exp(-kBegan / tau), g by
  // differences.
  const auto drift = [&](double a, double tau) { return a * std::exp(-kBegan / tau); };
  const double a = effect.parameters[0].value;
  const std::array<double, 2> g{drift(1.0, kTau), (drift(a, kTau + 1e-3) - drift(a, kTau - 1e-3)) / 2e-3};
  const auto& c = diagnosis.covariance;
  EXPECT_NEAR(g[0] * g[0] * c[4] + 2.0 * g[0] * g[1] * c[5] + g[1] * g[1] * c[8], 0.09, 1e-6);
  EXPECT_NEAR(g[0] * c[1] + g[1] * c[2], 0.002, 1e-8);  // with the other effect
  EXPECT_EQ(c[5], c[7]);
  EXPECT_EQ(c[1], c[3]);
  EXPECT_NEAR(effect.parameters[0].std_error, std::sqrt(c[4]), 1e-12);
  EXPECT_EQ(c[0], 0.01);
  EXPECT_EQ(c[8], 25.0);
  EXPECT_EQ(diagnosis.effects[0].effect.parameters[0].value, 2.0);
}

TEST(PowerUp, WhatSettlesLongAfterItIsShownAndNotCorrected) {
  Diagnosis diagnosis = found(4.0, 600.0);
  count_from_power_up(diagnosis, 2000.0);
  EXPECT_TRUE(diagnosis.effects[1].effect.shown_only);
  EXPECT_EQ(diagnosis.effects[1].effect.parameters[0].value, 4.0);
  ASSERT_EQ(diagnosis.remarks.size(), 1U);
}

TEST(PowerUp, SeveralCapturesHaveItWhereAllBeganAlike) {
  Capture none, early, late;
  early.since_power_up_s = 10.0;
  late.since_power_up_s = 12.0;
  EXPECT_EQ(began_after_power_up({early, early}), 10.0);
  EXPECT_FALSE(began_after_power_up({early, late}));
  EXPECT_FALSE(began_after_power_up({early, none}));
  EXPECT_FALSE(began_after_power_up({none}));
}

// What was fitted begins later than the record when its first part is kept back.
TEST(PowerUp, ItIsThatOfThePartThatWasFitted) {
  Capture one;
  one.since_power_up_s = 10.0;
  one.time_s = {0.0, 500.0, 1000.0};
  EXPECT_EQ(began_after_power_up({one}, 0.25), 260.0);
  Capture longer = one;
  longer.time_s.back() = 2000.0;
  EXPECT_EQ(began_after_power_up({one, longer}), 10.0);
  EXPECT_FALSE(began_after_power_up({one, longer}, 0.25));
}

class PoweredRecordings : public testing::Test, protected test::OwnFolder {
 protected:
  PoweredRecordings() {
    sensor_.name = "nose";
    sensor_.record.folder = folder();
  }
  // A closed file of so many bytes, of a sensor that was switched on then.
  void record(std::optional<std::int64_t> powered_ns, std::size_t bytes, const std::string& boot = "") {
    FlightHeader header;
    header.sensor = "nose";
    header.driver = "kvh1750";
    header.powered_ns = powered_ns;
    header.boot = boot;
    FlightArchive archive(make_flight_folder(path("nose")), {}, header);
    std::vector<std::uint8_t> payload(bytes);
    // That no compression makes smaller.
    for (std::uint32_t i = 0; i < bytes; ++i)
      payload[i] = static_cast<std::uint8_t>((i * 2654435761U) >> 13U ^ i * i);
    archive.add({FlightKind::bytes, 0, 0, 0, 1}, payload);
    archive.close(1, realtime_ns());
  }
  [[nodiscard]] std::vector<std::uint64_t> judged() const {
    std::vector<std::uint64_t> out;
    for (const RecordedFile& file : of_one_power_up(recorded_files(sensor_))) out.push_back(file.number);
    return out;
  }
  SensorConfig sensor_;
};

TEST_F(PoweredRecordings, OfSeveralPowerUpsTheLongestIsJudged) {
  constexpr std::int64_t kDay = 86'400'000'000'000;
  record(5 * kDay, 3000);
  record(6 * kDay, 2000);
  record(6 * kDay + 1'000'000'000,
         2500);  // another run of the daemon: its clock is off by what the wall clock was set
  record(7 * kDay, 1000);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{2, 3}));
  record(7 * kDay, 9000);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{4, 5}));
}

TEST_F(PoweredRecordings, AComputerWithoutAClockBeginsEveryDayAtTheSameTime) {
  constexpr std::int64_t kDay = 86'400'000'000'000;
  record(kDay, 2500, "one");
  record(kDay, 2000, "other");
  record(kDay + 1'000'000'000, 2000, "other");
  record(kDay, 3000, "third");
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{2, 3}));
}

TEST_F(PoweredRecordings, AllAreWhereNobodySaysWhenItWas) {
  record(std::nullopt, 100);
  record(std::nullopt, 2000);
  record(std::nullopt, 100);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{1, 2, 3}));
}

}  // namespace
}  // namespace ifog::tools
