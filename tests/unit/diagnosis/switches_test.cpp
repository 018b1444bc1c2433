// SPDX-License-Identifier: Apache-2.0
// What is on or off is its own square, and a heater's current that is read with noise is on or off as well.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {
namespace {

// A heater's current by a meter with a hundredth of it in noise, read once in eight samples, is on or off;
// what moves between, stands on a third level, or is a thermometer of whole degrees, is not.
TEST(Switches, AreToldThoughTheirLevelsAreReadWithNoise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto is_switch = [&](const std::string& name, const auto& value_at) {
    std::vector<double> time, rate, values;
    for (std::size_t i = 0; i < 4000; ++i) {
      time.push_back(0.125 * static_cast<double>(i));
      rate.push_back(1e-6 * normal(random));
      values.push_back(i % 8 == 0 ? value_at(time.back()) : std::nan(""));
    }
    Record record;
    record.name = "switched";
    record.time_s = time;
    record.rate_radps = rate;
    record.channels = {{name, values}};
    return cut_to_blocks({record}).channels.at(0).two_valued;
  };
  const auto on = [](double t) { return std::fmod(t, 45.0) < 20.0 ? 1.0 : 0.0; };
  EXPECT_TRUE(is_switch("heater_A", [&](double t) { return 1.2 * on(t) + 0.012 * normal(random); }));
  EXPECT_TRUE(is_switch("heater_on", on));
  EXPECT_TRUE(is_switch("pump_on", [](double t) { return t > 300.0 && t < 304.0 ? 1.0 : 0.0; }));
  EXPECT_FALSE(is_switch("heater_A", [&](double t) { return 1.2 * on(t) + 0.1 * normal(random); }));
  EXPECT_FALSE(is_switch("heater_A", [](double t) { return std::sin(0.1 * t); }));
  EXPECT_FALSE(is_switch("heater_A", [&](double t) { return on(t) + on(t + 10.0); }));
  EXPECT_FALSE(is_switch("housing_degC", [&](double t) { return 25.0 + on(t); }));
}

// A humidity that stood at one set point in one capture and at another in the next is no switch.
TEST(Switches, AreWithinOneCapture) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  std::vector<double> time, rate, dry, damp;
  for (std::size_t i = 0; i < 4000; ++i) {
    time.push_back(0.125 * static_cast<double>(i));
    rate.push_back(1e-6 * normal(random));
    dry.push_back(30.0 + 1.5 * std::sin(0.01 * time.back()));
    damp.push_back(dry.back() + 40.0);
  }
  Record one, other;
  one.name = "dry";
  other.name = "damp";
  one.time_s = other.time_s = time;
  one.rate_radps = other.rate_radps = rate;
  one.channels = {{"humidity_percent", dry}};
  other.channels = {{"humidity_percent", damp}};
  EXPECT_FALSE(cut_to_blocks({one, other}).channels.at(0).two_valued);
}

}  // namespace
}  // namespace ifog
