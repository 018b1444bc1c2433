// SPDX-License-Identifier: Apache-2.0
// Where nothing beside the sensor tells its rotation, an accelerometer may: what runs with it then is motion.
#include "filters/diagnosis/record/own_rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "filters/diagnosis/diagnose.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr double kGravity = 9.80665;
constexpr double kStep_s = 0.1;
constexpr std::size_t kSamples = 12000;

// A ship at its moorings: it rolls every eight seconds or so, by some four times roll_rad.
struct Ship {
  std::vector<double> time, rate, across, along, reference;

  Ship(std::uint64_t seed, double roll_rad, double noise_radps = 2e-6) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    // A damped swing, driven by the sea; the same in angle and rate.
    const double turn = 2.0 * M_PI * 0.12 * kStep_s, left = std::exp(-0.03 * turn);
    double x = 0.0, y = 0.0;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double next = left * (std::cos(turn) * x - std::sin(turn) * y) + 0.25 * normal(random);
      y = left * (std::sin(turn) * x + std::cos(turn) * y) + 0.25 * normal(random);
      const double before = roll_rad * x;
      x = next;
      time.push_back(kStep_s * static_cast<double>(i));
      reference.push_back((roll_rad * x - before) / kStep_s);
      rate.push_back(reference.back() + 4e-5 + noise_radps * normal(random));
      across.push_back(kGravity * std::sin(0.5 * (roll_rad * x + before)) + 2e-3 * normal(random));
      along.push_back(0.05 * std::sin(0.3 * time.back()) + 2e-3 * normal(random));
    }
  }
  [[nodiscard]] Record record(bool with_reference = false) const {
    Record record;
    record.name = "ship";
    record.time_s = time;
    record.rate_radps = rate;
    if (with_reference) record.reference_radps = reference;
    record.channels = {{"accel_x_mps2", along}, {"accel_y_mps2", across}};
    return record;
  }
};

TEST(OwnRotation, IsToldByTheAccelerationAcrossIt) {
  for (const double roll_rad : {0.02, 0.002, 0.0002}) {
    const Ship ship(7, roll_rad);
    BlockData data = cut_to_blocks({ship.record()});
    const std::vector<std::string> said = mark_own_rotation(data);
    ASSERT_EQ(said.size(), 1U) << roll_rad;
    EXPECT_EQ(said[0].find("accel_y_mps2 tells how the sensor itself tilts"), 0U) << said[0];
    EXPECT_FALSE(data.channels[0].rotates);
    EXPECT_TRUE(data.channels[1].rotates);
  }
}

TEST(OwnRotation, IsSaidWholeHoweverLongTheColumnsName) {
  const Ship ship(7, 0.02);
  Record record = ship.record();
  std::string name;
  for (int i = 0; i < 300; ++i) name += "\u00fc";
  record.channels[1].name = name + "_accel_mps2";
  BlockData data = cut_to_blocks({record});
  const std::vector<std::string> said = mark_own_rotation(data);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_TRUE(said[0].ends_with("no error is traced to " + record.channels[1].name));
}

TEST(OwnRotation, IsKnownWhereAReferenceStandsBeside) {
  const Ship ship(7, 0.02);
  BlockData data = cut_to_blocks({ship.record(true)});
  EXPECT_TRUE(mark_own_rotation(data).empty());
}

// What an acceleration does to a bias, at once or through a lag, is an error however large it is.
TEST(OwnRotation, IsNotWhatAnAccelerationDoesToABias) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    for (const double lag_s : {0.0, 3.0, 30.0}) {
      Ship ship(seed, 0.02);
      const Ship still(seed + 100, 0.0);
      double late = 0.0;
      for (std::size_t i = 0; i < kSamples; ++i) {
        late += (ship.across[i] - late) * (lag_s > 0.0 ? -std::expm1(-kStep_s / lag_s) : 1.0);
        ship.rate[i] = still.rate[i] + 1e-4 * late;  // 20 deg/h for 1 m/s^2
      }
      BlockData data = cut_to_blocks({ship.record()});
      EXPECT_TRUE(mark_own_rotation(data).empty()) << seed << ' ' << lag_s;
    }
  }
}

// Nothing is subtracted of a roll, and what else is wrong with the sensor is still traced.
TEST(OwnRotation, StaysInTheRateAndHidesNoOtherCause) {
  Ship ship(9, 2e-4);
  std::vector<double> supply;
  for (std::size_t i = 0; i < kSamples; ++i) {
    supply.push_back(24.0 + 0.5 * std::sin(2.0 * M_PI * ship.time[i] / 400.0));
    ship.rate[i] += 2e-5 * (supply.back() - 24.0);
  }
  Record record = ship.record();
  record.channels.push_back({"supply_V", supply});
  const Diagnosis found = diagnose({record}, {});
  bool traced = false;
  for (const FoundEffect& each : found.effects) {
    EXPECT_EQ(each.effect.channel.find("accel"), std::string::npos) << each.effect.form;
    traced = traced || each.effect.channel == "supply_V";
  }
  EXPECT_TRUE(traced);
}

// A telescope that follows a star: its motor turns the gyro, a fan and the wind do not.
TEST(OwnRotation, IsToldByWhatTurnsTheSensor) {
  Ship mount(12, 0.0);
  std::vector<double> motor, fan;
  for (std::size_t i = 0; i < kSamples; ++i) {
    motor.push_back(0.25 + 0.05 * std::sin(2.0 * M_PI * mount.time[i] / 300.0));
    fan.push_back(1200.0 + 100.0 * std::sin(2.0 * M_PI * mount.time[i] / 170.0));
    mount.rate[i] += 3e-4 * motor.back() + 5e-8 * (fan.back() - 1200.0);
  }
  Record record = mount.record();
  record.channels = {{"motor_rpm", motor}, {"fan_rpm", fan}};
  const Diagnosis found = diagnose({record}, {});
  bool of_fan = false;
  for (const FoundEffect& each : found.effects) {
    EXPECT_NE(each.effect.channel, "motor_rpm");
    of_fan = of_fan || each.effect.channel == "fan_rpm";
  }
  EXPECT_TRUE(of_fan);
  const auto told = [](const std::string& remark) {
    return remark.starts_with("motor_rpm tells how the sensor is moved");
  };
  EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), told));
}

// A gyro that is set to one heading after the other meets the Earth's rate once a turn: shown, never
// subtracted unasked; what is larger than the Earth's rate is an error.
TEST(OwnRotation, OfTheEarthIsShownOverATurnOfHeadings) {
  constexpr double kEarth = 7.292115e-5;
  for (const double size : {0.67 * kEarth, 3.0 * kEarth}) {
    Ship finder(13, 0.0);
    std::vector<double> heading;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double at = 30.0 * std::floor(finder.time[i] / 50.0);
      heading.push_back(std::fmod(at, 360.0));
      finder.rate[i] += size * std::cos((at + 37.0) * M_PI / 180.0);
    }
    Record record = finder.record();
    record.channels = {{"table_angle_deg", heading}};
    const bool is_earth = size < kEarth;
    for (const bool asked : {false, true}) {
      DiagnoseOptions options;
      options.subtract_earth_rate = asked;
      const Diagnosis found = diagnose({record}, options);
      ASSERT_GE(found.effects.size(), 2U);
      for (const FoundEffect& each : found.effects)
        EXPECT_EQ(each.effect.shown_only, is_earth && !asked) << each.effect.form;
      const double left = found.after.at("rms_10s_radps") / found.before.at("rms_10s_radps");
      if (is_earth && !asked)
        EXPECT_GT(left, 0.99);
      else
        EXPECT_LT(left, 0.1);
    }
  }
}

// The Earth makes nothing twice a turn: what is larger there than once a turn is an error.
TEST(OwnRotation, OfTheEarthIsNotTwiceATurn) {
  Ship finder(14, 0.0);
  std::vector<double> heading;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double at = 30.0 * std::floor(finder.time[i] / 50.0);
    heading.push_back(std::fmod(at, 360.0));
    finder.rate[i] += 2e-6 * std::cos(at * M_PI / 180.0) + 5e-5 * std::cos((2.0 * at + 40.0) * M_PI / 180.0);
  }
  Record record = finder.record();
  record.channels = {{"table_angle_deg", heading}};
  const Diagnosis found = diagnose({record}, {});
  EXPECT_LT(found.after.at("rms_10s_radps"), 0.1 * found.before.at("rms_10s_radps"));
}

// Where a bias follows the change of a temperature, the angle turned follows the temperature, and so does an
// accelerometer that drifts with it: neither tilts.
TEST(OwnRotation, IsNotWhatATemperatureDoesToBoth) {
  Ship still(15, 0.0);
  std::vector<double> temperature;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double t = still.time[i];
    temperature.push_back(25.0 + 5.0 * std::sin(2.0 * M_PI * t / 400.0));
    still.rate[i] += 3e-5 * 5.0 * 2.0 * M_PI / 400.0 * std::cos(2.0 * M_PI * t / 400.0);
    still.across[i] += 2e-3 * (temperature.back() - 25.0);
  }
  Record record = still.record();
  record.channels.push_back({"temperature_degC", temperature});
  BlockData data = cut_to_blocks({record});
  EXPECT_TRUE(mark_own_rotation(data).empty());
}

TEST(OwnRotation, IsToldByNamesOfWhatCarriesTheSensor) {
  for (const char* name : {"speed_mps", "vehicle_speed_kmh", "motor_rpm", "wheel_rpm", "steering_deg",
                           "curvature_permm", "gimbal_rate_degps"})
    EXPECT_TRUE(tells_motion(name)) << name;
  for (const char* name : {"compressor_rpm", "cooler_rpm", "fan_rpm", "coolant_flow_mps", "wind_speed_mps",
                           "motor_A", "temp_air_degC", "valve_open", "fan_speed_mps", "supply_V"})
    EXPECT_FALSE(tells_motion(name)) << name;
}

}  // namespace
}  // namespace ifog
