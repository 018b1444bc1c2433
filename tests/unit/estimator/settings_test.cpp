// SPDX-License-Identifier: Apache-2.0
// Settings that cannot work are refused by name, with the value and what was expected.
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>

#include "filters/estimator/estimator.h"

namespace {

using ifog::Estimator;
using ifog::FilterSettings;

FilterSettings good() {
  FilterSettings settings;
  settings.process_noise = 1e-9;
  settings.measurement_noise = 1e-8;
  return settings;
}

std::string refusal(const std::function<void(FilterSettings&)>& change, int axes = 1,
                    double period_s = 0.01) {
  FilterSettings settings = good();
  change(settings);
  try {
    const Estimator estimator(settings, axes, period_s);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(EstimatorSettings, AreRefusedByNameAndValue) {
  EXPECT_EQ(refusal([](FilterSettings&) {}), "accepted");
  EXPECT_EQ(refusal([](FilterSettings& s) { s.process_noise = 0; }),
            "process_noise: 0, expected a positive spectral density in (rad/s)^2/s");
  EXPECT_EQ(refusal([](FilterSettings& s) { s.measurement_noise = -1; }),
            "measurement_noise: -1, expected a positive variance in (rad/s)^2");
  EXPECT_EQ(refusal([](FilterSettings& s) { s.weights = "none"; }),
            "weights: 'none', expected \"kept\" | \"fresh\" | \"uniform\"");
  EXPECT_EQ(refusal([](FilterSettings& s) { s.window = 1; }),
            "window: 1, expected a whole number 2 ... 100000");
  EXPECT_EQ(refusal([](FilterSettings&) {}, 4), "axes: 4, expected 1 to 3");
  EXPECT_NE(refusal([](FilterSettings& s) { s.rule = "wizard"; }).find("rule: 'wizard', expected one of ckf"),
            std::string::npos);
  EXPECT_NE(
      refusal([](FilterSettings& s) { s.state = "flat"; }).find("state: 'flat', expected one of random-walk"),
      std::string::npos);
}

}  // namespace
