// SPDX-License-Identifier: Apache-2.0
// Settings that cannot work are refused by name, with the value and what was expected.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "filters/estimator/estimator.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/refusal.h"

namespace {

using ifog::Estimator;
using ifog::FilterSettings;

FilterSettings good() {
  FilterSettings settings;
  settings.process_noise = 1e-9;
  settings.measurement_noise = 1e-8;
  return settings;
}

TEST(EstimatorSettings, AreRefusedByNameAndValue) {
  struct Row {
    std::function<void(FilterSettings&)> change;
    const char* said;
    int axes = 1;
  };
  for (const Row& row : {
           Row{[](FilterSettings&) {}, "accepted"},
           Row{[](FilterSettings& s) { s.process_noise = 0; },
               "process_noise: 0, expected a positive spectral density in (rad/s)^2/s"},
           Row{[](FilterSettings& s) { s.process_noise = 1e308; },
               "process_noise: 1e+308, expected a number 0 ... 1e+12"},
           Row{[](FilterSettings& s) { s.measurement_noise = -1; },
               "measurement_noise: -1, expected a positive variance in (rad/s)^2"},
           Row{[](FilterSettings& s) { s.measurement_noise = 1e-308; },
               "measurement_noise: 1e-308, expected a number 1e-60 ... 1e+12, or 0"},
           Row{[](FilterSettings& s) { s.weights = "none"; },
               "weights: 'none', expected \"kept\" | \"fresh\" | \"uniform\""},
           Row{[](FilterSettings& s) { s.window = 1; }, "window: 1, expected a whole number 2 ... 100000"},
           Row{[](FilterSettings& s) { s.rule = "wizard"; }, "rule: 'wizard', expected one of ckf"},
           Row{[](FilterSettings& s) { s.state = "flat"; }, "state: 'flat', expected one of random-walk"},
           Row{[](FilterSettings&) {}, "axes: 4, expected 1 to 3", 4},
       }) {
    FilterSettings settings = good();
    row.change(settings);
    const std::string said = ifog::test::refusal([&] { Estimator(settings, row.axes, 0.01); });
    EXPECT_TRUE(said.starts_with(row.said)) << row.said << ", found " << said;
  }
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
          ifog::test::Fed filter(settings, 1, 0.005);
          filter.in.covered_s[0] = 0.005;
          for (int n = 0; n < 600; ++n) {
            const ifog::EstimatorOutput& out =
                filter.step({1e-3 * (n * 7919 % 101) + (n > 300 && n < 400 ? 0.5 : 0.0)});
            ASSERT_TRUE(std::isfinite(out.denoised_radps[0]))
                << rule << ' ' << plain << ' ' << process << ' ' << measurement << ", sample " << n;
            ASSERT_GE(out.variance_rad2ps2[0], 0.0)
                << rule << ' ' << plain << ' ' << process << ' ' << measurement << ", sample " << n;
          }
        }
}

}  // namespace
