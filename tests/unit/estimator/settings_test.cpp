// SPDX-License-Identifier: Apache-2.0
// Settings that cannot work are refused by name, with the value and what was expected.
#include <gtest/gtest.h>

#include <cmath>
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

// As loud and as quiet as is let in, over a step of half a radian a second: every rule's numbers stay
// numbers, and no variance is negative, also of a rule without a floor.
TEST(EstimatorSettings, ThatAreAcceptedGiveNumbers) {
  for (const double process : {1e-300, 1e-60, 1e-9, 1e12})
    for (const double measurement : {1e-60, 1e-8, 1e12})
      for (const char* const rule : {"ckf", "irwe-akfg", "iae", "rae", "mmae", "sage-husa", "vb"})
        for (const bool plain : {false, true}) {
          FilterSettings settings = good();
          settings.process_noise = process;
          settings.measurement_noise = measurement;
          settings.rule = rule;
          settings.plain = plain;
          settings.window = 2;
          settings.weights = "fresh";
          Estimator estimator(settings, 1, 0.005);
          ifog::EstimatorInput in;
          ifog::EstimatorOutput out;
          in.valid_axes = 1;
          in.dt_s = in.covered_s[0] = 0.005;
          for (std::uint64_t n = 0; n < 600; ++n) {
            in.sequence = n;
            in.rate_radps[0] = 1e-3 * static_cast<double>(n * 7919 % 101) + (n > 300 && n < 400 ? 0.5 : 0.0);
            estimator.step(in, out);
            ASSERT_TRUE(std::isfinite(out.denoised_radps[0]))
                << rule << ' ' << plain << ' ' << process << ' ' << measurement << ", sample " << n;
            ASSERT_GE(out.variance_rad2ps2[0], 0.0)
                << rule << ' ' << plain << ' ' << process << ' ' << measurement << ", sample " << n;
          }
        }
}

TEST(EstimatorSettings, WhoseArithmeticWouldOverflowAreRefused) {
  EXPECT_EQ(refusal([](FilterSettings& s) { s.process_noise = 1e308; }),
            "process_noise: 1e+308, expected a number 0 ... 1e+12");
  EXPECT_EQ(refusal([](FilterSettings& s) { s.measurement_noise = 1e-308; }),
            "measurement_noise: 1e-308, expected a number 1e-60 ... 1e+12, or 0");
}

}  // namespace
