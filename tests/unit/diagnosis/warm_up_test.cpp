// SPDX-License-Identifier: Apache-2.0
// A warm-up is what no channel explains, and what the start of the filter does not make by itself.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

// Two hours at 1 Hz beside a thermometer; noise 1e-6 rad/s.
Diagnosis diagnosis_of(const std::function<double(double)>& temperature,
                       const std::function<double(double t, double celsius)>& error, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> time, rate, celsius;
  for (int i = 0; i < 7200; ++i) {
    const double t = i;
    time.push_back(t);
    celsius.push_back(temperature(t) + 0.004 * normal(random));
    rate.push_back(error(t, temperature(t)) + 1e-6 * normal(random));
  }
  return diagnose({made_record("two hours", time, rate, {{"temperature_degC", celsius}})}, {});
}

std::vector<std::string> named(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const FoundEffect& found : diagnosis.effects)
    names.push_back(found.effect.form + (found.effect.channel.empty() ? "" : " of " + found.effect.channel));
  return names;
}

// A sensor that heats itself: a bias with a turning point at 31 °C settles much as a warm-up does.
TEST(WarmUp, WhatTheTemperatureExplainsIsTheTemperatures) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Diagnosis found =
        diagnosis_of([](double t) { return 38.0 - 14.0 * std::exp(-t / 1100.0) + 0.5 * std::sin(t / 400.0); },
                     [](double, double celsius) { return 2e-8 * std::pow(celsius - 31.0, 2); }, seed);
    ASSERT_FALSE(found.effects.empty()) << seed;
    for (const std::string& name : named(found))
      EXPECT_NE(name.find(" of temperature_degC"), std::string::npos) << seed << ' ' << name;
  }
}

// One that does not heat itself in a room of its own weather.
TEST(WarmUp, WhatNoChannelExplainsIsAWarmUp) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Diagnosis found =
        diagnosis_of([](double t) { return 22.0 + 2.0 * std::sin(t / 900.0 + 1.0) + std::sin(t / 330.0); },
                     [](double t, double) { return 1e-6 * std::exp(-t / 500.0); }, seed);
    EXPECT_EQ(named(found), std::vector<std::string>{"warm_up"}) << seed;
  }
}

// A record of 1e-6 rad/s exp(-t / 500 s) and noise of 1e-7 rad/s that begins so long after power-up.
struct Settling {
  std::vector<double> time, rate;
  explicit Settling(double on_s, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 7200; ++i) {
      time.push_back(i);
      rate.push_back(1e-6 * std::exp(-(on_s + i) / 500.0) + 1e-7 * normal(random));
    }
  }
  [[nodiscard]] Record on_for(double on_s) const {
    Record record = made_record("settling", time, rate, {});
    record.since_power_up_s = on_s;
    return record;
  }
};

void expect_the_law(const Diagnosis& found) {
  ASSERT_EQ(named(found), std::vector<std::string>{"warm_up"});
  const std::vector<ModelParameter>& is = found.effects[0].effect.parameters;
  EXPECT_NEAR(is[0].value, 1e-6, std::min(3e-7, 5.0 * is[0].std_error));
  EXPECT_NEAR(is[1].value, 500.0, 5.0 * is[1].std_error);
}

TEST(WarmUp, ItCountsFromPowerUp) {
  const Settling late(400.0, 1), early(0.0, 2);
  expect_the_law(diagnose({late.on_for(400.0)}, {}));
  expect_the_law(diagnose({early.on_for(0.0), late.on_for(400.0)}, {}));
}

// Judged by the daemon's compensator on the whole record, whose first twentieth was not fitted.
TEST(WarmUp, TheFirstPartMayBeKeptBack) {
  DiagnoseOptions options;
  options.fit_from = 0.05;
  const Diagnosis found = diagnose({Settling(0.0, 3).on_for(0.0)}, options);
  expect_the_law(found);
  EXPECT_LT(found.after.at("rms_10s_radps"), 0.3 * found.before.at("rms_10s_radps"));
}

// After six time constants nobody knows what it was at power-up.
TEST(WarmUp, NoneIsCorrectedThatIsLongPast) {
  const Diagnosis found = diagnose({Settling(0.0, 4).on_for(3000.0)}, {});
  ASSERT_EQ(named(found), std::vector<std::string>{"warm_up"});
  EXPECT_TRUE(found.effects[0].effect.shown_only);
  EXPECT_NEAR(found.effects[0].effect.parameters[0].value, 1e-6, 1e-7);
  EXPECT_EQ(found.after.at("rms_100s_radps"), found.before.at("rms_100s_radps"));
}

}  // namespace
}  // namespace ifog
