// SPDX-License-Identifier: Apache-2.0
// A channel that is logged early is used when it acts: at any rate of samples, over gaps and a reload.
#include "filters/effects/delayed_reading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/effects/compensated.h"

namespace ifog {
namespace {

// Straight pieces: what a reading between two kept ones is, is known exactly but at their corners.
double saw(double t) { return 3.0 * std::abs(std::fmod(t, 100.0) - 50.0); }

TEST(DelayedReading, IsTheReadingOfSoLongAgo) {
  for (const double dt_s : {0.001, 0.013, 0.1, 2.5}) {
    DelayedReading delayed(40.0);
    EXPECT_TRUE(delayed.delays());
    EXPECT_FALSE(delayed.begun());
    for (double i = 0.0; i * dt_s < 230.0; i += 1.0) {
      const double t = i * dt_s;
      const double value = delayed.step(saw(t), dt_s);
      // At a corner a line between kept readings cuts by no more than the slope over their distance.
      const double most = 3.0 * (0.08 + dt_s);
      EXPECT_NEAR(value, saw(std::max(0.0, t - 40.0)), most) << dt_s << " " << t;
      const bool corner = std::fmod(std::abs(t - 40.0) + 1.0 + dt_s, 50.0) < 2.0 + 2.0 * dt_s;
      if (!corner) {
        EXPECT_NEAR(value, saw(std::max(0.0, t - 40.0)), 1e-9) << dt_s << " " << t;
      }
    }
  }
}

Compensator waiting(double early_s) {
  Model model;
  model.effects = {linear(1e-6)};
  model.ranges = {{"temperature_degC", 0.0, 50.0, early_s}};
  return Compensator(model, {""});
}

TEST(DelayedReading, ACompensatorWaits) {
  Compensator compensator = waiting(1.0);  // a hundred steps
  for (int i = 0; i < 300; ++i) {
    const double reading = i < 50 ? 25.0 : 35.0;
    const CompensatorOutput out = step(compensator, 0.0, {i % 7 == 3 ? kMissing : reading});
    if (i < 149) {
      EXPECT_EQ(out.correction_radps[0], 0.0) << i;
    } else if (i > 151) {
      EXPECT_DOUBLE_EQ(out.correction_radps[0], 10e-6) << i;
    }
  }
}

TEST(DelayedReading, GoesOnOverAReload) {
  Compensator before = waiting(1.0);
  for (int i = 0; i < 200; ++i) step(before, 0.0, {25.0});
  Compensator after = waiting(1.0);
  after.take_over(before);
  for (int i = 0; i < 90; ++i) EXPECT_EQ(step(after, 0.0, {35.0}).correction_radps[0], 0.0) << i;
}

}  // namespace
}  // namespace ifog
