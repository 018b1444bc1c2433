// SPDX-License-Identifier: Apache-2.0
// A channel that is logged early is used when it acts: at any rate of samples, over gaps and a reload.
#include "filters/effects/delayed_reading.h"
#include "filters/effects/plausible_reading.h"
#include "tests/unit/effects/compensated.h"
#include "tests/unit/test.h"

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

// What a logger writes where it has no value is no reading; what a channel may do, however seldom, is one.

const ChannelRange kVibration{"accel_x_mps2", -10.0, 10.0};
const ChannelRange kRoom{"temperature_degC", 20.0, 35.0};

// A channel that swings from sample to sample.
double vibration(int i) { return 9.0 * std::sin(2.4 * i); }
// Hundredths of a degree from sample to sample.
double warmth(int i) { return 25.0 + 0.01 * i; }

template <class Value>
PlausibleReading after(int samples, double dt_s, const ChannelRange& range, Value&& value) {
  PlausibleReading reading;
  for (int i = 0; i < samples; ++i) EXPECT_TRUE(reading.step(value(i), dt_s, range)) << i;
  return reading;
}

TEST(PlausibleReading, APlaceholderIsNoneForAsLongAsItStands) {
  PlausibleReading reading = after(200, 0.01, kVibration, vibration);
  for (int i = 0; i < 20000; ++i) EXPECT_FALSE(reading.step(9999.0, 0.01, kVibration)) << i;
  EXPECT_TRUE(reading.step(3.0, 0.01, kVibration));
}

TEST(PlausibleReading, AVibrationThatGrewIsOne) {
  PlausibleReading reading = after(200, 0.01, kVibration, vibration);
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(reading.step(10.0 * vibration(i), 0.01, kVibration)) << i;
}

TEST(PlausibleReading, WhatASlowChannelNeverDidIsNoneForAMinute) {
  PlausibleReading reading = after(100, 1.0, kRoom, warmth);
  for (const double value : {85.0, -127.0, 85.0}) EXPECT_FALSE(reading.step(value, 1.0, kRoom)) << value;
  EXPECT_TRUE(reading.step(26.1, 1.0, kRoom));
  // A room that is another now: it moves, and after a minute it is believed.
  int refused = 0;
  for (int i = 0; i < 100; ++i) refused += reading.step(60.0 + 0.01 * i, 1.0, kRoom) ? 0 : 1;
  EXPECT_EQ(refused, 60);
}

TEST(PlausibleReading, ASlowChannelThatWalksOutOfItsRangeIsOne) {
  PlausibleReading reading = after(100, 1.0, kRoom, warmth);
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(reading.step(26.0 + 0.1 * i, 1.0, kRoom)) << i;
}

TEST(PlausibleReading, BehindAGapOfAMinuteTheChannelMayBeElsewhere) {
  PlausibleReading reading = after(100, 1.0, kRoom, warmth);
  for (int i = 0; i < 70; ++i) EXPECT_FALSE(reading.step(std::nan(""), 1.0, kRoom));
  EXPECT_TRUE(reading.step(60.0, 1.0, kRoom));
}

TEST(PlausibleReading, OfAChannelWithoutARangeOrAHistoryNothingIsKnown) {
  PlausibleReading without, fresh;
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(without.step(1.0, 0.01, {"x", -infinite, infinite}));
  EXPECT_TRUE(without.step(1e9, 0.01, {"x", -infinite, infinite}));
  EXPECT_FALSE(fresh.step(9999.0, 0.01, kVibration));
}

// As a thermometer says what it was made with before it has measured.
TEST(PlausibleReading, ANumberThatIsNoneIsRefusedAtTheBeginningTooAndTeachesNothing) {
  PlausibleReading reading;
  EXPECT_FALSE(reading.step(9999.0, 1.0, kRoom));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(reading.step(warmth(i), 1.0, kRoom));
  EXPECT_FALSE(reading.step(85.0, 1.0, kRoom));
}

// Where the computer is first switched on far from where its gyro was calibrated.
TEST(PlausibleReading, WhatGoesOnForAMinuteIsTheChannel) {
  PlausibleReading reading;
  int refused = 0;
  for (int i = 0; i < 600; ++i) refused += reading.step(-900.0 + warmth(i), 1.0, kRoom) ? 0 : 1;
  EXPECT_LE(refused, 60);
}

// Held as a missing one is, and flagged so: neither range nor variance is made of a logger's number.
TEST(Compensator, HoldsAChannelThatIsNoReading) {
  Model model;
  model.effects = {linear(1e-6)};
  model.ranges = {{"temperature_degC", 20.0, 35.0}};
  Compensator compensator(model, {""});
  for (int i = 0; i < 100; ++i) step(compensator, 0.0, {warmth(i)});
  const double before = step(compensator, 0.0, {26.0}).correction_radps[0];
  const CompensatorOutput out = step(compensator, 0.0, {85.0});
  EXPECT_DOUBLE_EQ(out.correction_radps[0], before);
  EXPECT_EQ(out.flags, static_cast<std::uint32_t>(kStaleChannel));
}

}  // namespace
}  // namespace ifog
