// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/compensator.h"
#include "filters/effects/compensate_series.h"
#include "filters/model_file/channel_names.h"
#include "tests/unit/effects/compensated.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// z made from a known rate by the model's own statement, solved back.
TEST(Compensator, InvertsAScaleFactorThatDependsOnTemperatureAndRate) {
  Model model;
  Effect drift;
  drift.form = "product";
  drift.channel = "temperature_degC";
  drift.reference = 25.0;
  drift.with_form = "linear";
  drift.with_channel = "reference_rate_radps";
  drift.parameters = {{"coefficient", -4.7e-4, 0.0, ""}};
  model.effects = {linear(2e-5), of_rate("linear", 0.01), of_rate("cubic", -3e-3), drift};
  Compensator compensator(model, {"z"});
  for (const double w : {-2.0, -0.3, 0.0, 1e-4, 0.7, 2.5}) {
    const double t = 55.0;
    const double z = w + 2e-5 * (t - 25.0) + 0.01 * w - 3e-3 * w * w * w - 4.7e-4 * (t - 25.0) * w;
    EXPECT_NEAR(step(compensator, z, {t}).compensated_radps[0], w, 1e-11) << w;
  }
}

// A reference of reversed sign, or in another unit. What leaves the fitted range stays a rate.
TEST(Compensator, InvertsAScaleFactorErrorOfAnySize) {
  for (const double error : {-2.0, -0.98, -0.5, 0.9}) {
    Model model;
    model.effects = {of_rate("linear", error)};
    model.ranges = {{"reference_rate_radps", -5.0, 12.0}};
    Compensator compensator(model, {""});
    for (const double w : {-5.0, -0.3, 1e-4, 4.0, 12.0})
      EXPECT_NEAR(step(compensator, (1.0 + error) * w, {}).compensated_radps[0], w, 1e-10)
          << error << ' ' << w;
    const double outside = 100.0 * (1.0 + error);
    EXPECT_LT(std::abs(step(compensator, outside, {}).compensated_radps[0]), 300.0) << error;
  }
}

// Three axes that see parts of each other's rotation: z = (1 + D) w + M w, solved by Cramer's rule.
TEST(Compensator, SolvesMisalignmentForAllAxesAtOnce) {
  const double m = 3e-3;   // of y in x
  const double k = -2e-3;  // of x in y
  const double s = 5e-3;   // scale factor of x
  Model model;
  Effect on_x = of_rate("linear", m);
  on_x.channel = "rate_y_radps";
  on_x.axis = "x";
  Effect on_y = of_rate("linear", k);
  on_y.channel = "rate_x_radps";
  on_y.axis = "y";
  Effect scale = of_rate("linear", s);
  scale.axis = "x";
  model.effects = {on_x, on_y, scale};
  Compensator compensator(model, {"x", "y", "z"});
  EXPECT_TRUE(compensator.channels().empty()) << "the other axes come with the sample";
  CompensatorInput in;
  in.dt_s = 0.01;
  in.rate_radps = {0.7, -1.3, 0.2};
  CompensatorOutput out;
  compensator.step(in, out);
  const double determinant = (1.0 + s) - m * k;
  EXPECT_NEAR(out.compensated_radps[0], (0.7 - m * -1.3) / determinant, 1e-14);
  EXPECT_NEAR(out.compensated_radps[1], ((1.0 + s) * -1.3 - k * 0.7) / determinant, 1e-14);
  EXPECT_EQ(out.compensated_radps[2], 0.2);
  EXPECT_EQ(out.flags, 0U);

  in.rate_radps[1] = kMissing;
  compensator.step(in, out);
  EXPECT_NEAR(out.compensated_radps[0], 0.7 / (1.0 + s), 1e-14) << "without the other axis its part stays";
  EXPECT_NE(out.flags & kStaleChannel, 0U);
}

// A sensor of one axis with the column of another: the column is a channel.
TEST(Compensator, AnotherAxisThatIsNotTheSensorsIsAChannel) {
  Model model;
  model.effects = {of_rate("linear", 1e-3)};
  model.effects[0].channel = "rate_y_radps";
  Compensator compensator(model, {""});
  ASSERT_EQ(compensator.channels(), std::vector<std::string>{"rate_y_radps"});
  EXPECT_NEAR(step(compensator, 0.1, {0.5}).compensated_radps[0], 0.1 - 5e-4, 1e-15);
}

TEST(Compensator, InvertsAnotherScaleFactorBackwards) {
  Model model;
  Effect bias = of_rate("absolute", 0.02);
  bias.reference = 1e-3;
  model.effects = {bias};
  Compensator compensator(model, {""});
  for (const double w : {-2.0, -0.3, 0.0, 1e-3, 0.7}) {
    const double z = w + 0.02 * std::abs(w - 1e-3);
    EXPECT_NEAR(step(compensator, z, {}).compensated_radps[0], w, 1e-13) << w;
  }
}

TEST(Compensator, TakesADifferenceOfChannelsWithinItsOwnRange) {
  Model model;
  Effect gradient = linear(1e-6);
  gradient.channel = difference_of("inner_degC", "outer_degC");
  gradient.reference = 0.0;
  model.effects = {gradient, linear(2e-6)};
  model.ranges = {{gradient.channel, -2.0, 2.0}, {"temperature_degC", 0.0, 50.0}};
  Compensator compensator(model, {""});
  ASSERT_EQ(compensator.channels(),
            (std::vector<std::string>{"inner_degC", "outer_degC", "temperature_degC"}));
  const auto none = step(compensator, 0.0, {30.0, kMissing, 25.0});
  EXPECT_EQ(none.correction_radps[0], 0.0) << "half a difference is none";
  const auto inside = step(compensator, 0.0, {80.0, 79.0, 26.0});
  EXPECT_NEAR(inside.correction_radps[0], 1e-6 + 2e-6, 1e-18);
  EXPECT_EQ(inside.flags, 0U) << "of the two only the difference has a range";
  EXPECT_NE(step(compensator, 0.0, {80.0, 75.0, 26.0}).flags & kOutOfRange, 0U);
  Compensator next(model, {""});
  next.take_over(compensator);
  EXPECT_NEAR(step(next, 0.0, {kMissing, kMissing, 25.0}).correction_radps[0], 5e-6, 1e-18) << "held at 5";
}

// What a logger writes where it has no value, in one of the two that have no range of their own.
TEST(Compensator, ADifferenceThatNeverWasOneCorrectsNothingAndIsHeldOverAReload) {
  Model model;
  Effect gradient = linear(1e-6);
  gradient.channel = difference_of("inner_degC", "outer_degC");
  gradient.reference = 12.0;
  model.effects = {gradient};
  model.ranges = {{gradient.channel, 10.0, 14.0}};
  Compensator compensator(model, {""});
  const auto none = step(compensator, 0.0, {9999.0, 30.0});
  EXPECT_EQ(none.correction_radps[0], 0.0);
  EXPECT_NE(none.flags & kNoChannelYet, 0U);
  EXPECT_NEAR(step(compensator, 0.0, {43.0, 30.0}).correction_radps[0], 1e-6, 1e-18);
  const auto held = step(compensator, 0.0, {9999.0, 30.0});
  EXPECT_NEAR(held.correction_radps[0], 1e-6, 1e-18);
  EXPECT_EQ(held.flags, static_cast<std::uint32_t>(kStaleChannel));
  Compensator next(model, {""});
  next.take_over(compensator);
  EXPECT_NEAR(step(next, 0.0, {9999.0, 30.0}).correction_radps[0], 1e-6, 1e-18);
}

TEST(Compensator, ADifferenceOfAnglesIsOneThroughTheirWraps) {
  Model model;
  Effect effect = linear(1e-6);
  effect.form = "sine";
  effect.channel = difference_of("inner_deg", "outer_deg");
  effect.reference = 0.0;
  effect.period = 360.0;
  model.effects = {effect};
  model.ranges = {{effect.channel, -30.0, 10.0}};
  Compensator compensator(model, {""});
  for (double outer = 0.0; outer < 720.0; outer += 17.0)
    for (const double apart : {-30.0, -20.0, -1.0, 9.0}) {
      const double inner = std::fmod(outer + apart + 360.0, 360.0);
      const auto out = step(compensator, 0.0, {inner, std::fmod(outer, 360.0)});
      EXPECT_NEAR(out.correction_radps[0], 1e-6 * std::sin(apart * M_PI / 180.0), 1e-15)
          << inner << ' ' << outer;
      EXPECT_EQ(out.flags, 0U);
    }
}

TEST(Compensator, FollowsAnAngleThroughItsWraps) {
  Model model;
  for (const char* form : {"cosine", "sine"}) {
    Effect effect;
    effect.form = form;
    effect.channel = "table_deg";
    effect.period = 180.0;
    effect.parameters = {{"coefficient", form[0] == 'c' ? 3e-6 : -2e-6, 0.0, "rad/s"}};
    model.effects.push_back(effect);
  }
  Compensator compensator(model, {""});
  for (const double degrees : {0.0, 33.0, 179.0, 359.5, -20.0, 730.0}) {
    const double phase = 2.0 * degrees * M_PI / 180.0;
    const auto out = step(compensator, 1e-3, {degrees});
    EXPECT_NEAR(out.correction_radps[0], 3e-6 * std::cos(phase) - 2e-6 * std::sin(phase), 1e-18) << degrees;
    EXPECT_EQ(out.flags, 0U);
  }
  model.effects[0].period = 0.0;
  EXPECT_THROW(Compensator(model, {""}), std::invalid_argument);
}

// A range of the angle, written by hand, say: a turn further the same comes again.
TEST(Compensator, APeriodicEffectGoesOnBeyondItsRange) {
  Model model;
  Effect effect;
  effect.form = "cosine";
  effect.channel = "heading_deg";
  effect.period = 360.0;
  effect.parameters = {{"coefficient", 3e-6, 0.0, "rad/s"}};
  model.effects = {effect};
  model.ranges = {{"heading_deg", 0.0, 360.0}};
  Compensator compensator(model, {""});
  for (const double degrees : {100.0, 400.0, 1000.0, -5000.0})
    EXPECT_NEAR(step(compensator, 0.0, {degrees}).correction_radps[0],
                3e-6 * std::cos(degrees * M_PI / 180.0), 1e-17)
        << degrees;
}

TEST(Compensator, AnErrorThatIsNotKnownAddsNothing) {
  Model model;
  model.effects = {linear(1e-6)};
  model.effects[0].parameters[0].std_error = kMissing;
  model.ranges = {{"temperature_degC", 10.0, 40.0}};
  Compensator compensator(model, {""});
  for (const double t : {30.0, 60.0}) {
    const CompensatorOutput out = step(compensator, 1e-3, {t});
    EXPECT_TRUE(std::isfinite(out.compensated_radps[0]) && std::isfinite(out.variance_rad2ps2[0])) << t;
  }
}

TEST(Compensator, ADifferenceOfRatesIsRefused) {
  for (const auto& [of, less] :
       {std::pair{"reference_rate_radps", "rate_cmd_radps"}, {"rate_y_radps", "rate_z_radps"}}) {
    Model model;
    model.effects = {linear(1e-6)};
    model.effects[0].channel = difference_of(of, less);
    EXPECT_THROW(Compensator(model, {"x", "y", "z"}), std::invalid_argument) << of;
  }
}

// An axis that measured nothing is outside no range.
TEST(Compensator, AnUnmeasuredAxisIsNotOutsideTheRange) {
  Model model;
  model.effects = {of_rate("linear", 0.01)};
  Compensator compensator(model, {""});
  EXPECT_EQ(step(compensator, kMissing, {}).flags & kOutOfRange, 0U);
}

TEST(Compensator, WhatIsOnlyShownIsNotTakenAway) {
  Model model;
  model.effects = {linear(1e-6)};
  model.effects[0].shown_only = true;
  Compensator compensator(model, {""});
  EXPECT_EQ(compensator.left_out(), std::vector<std::string>{"linear of temperature_degC"});
  EXPECT_EQ(step(compensator, 0.5, {}).compensated_radps[0], 0.5);
}

TEST(Compensator, HoldsAStaleChannelAndSaysSo) {
  Model model;
  model.effects = {linear(1e-6)};
  Compensator compensator(model, {""}, 2.0);
  const auto before = step(compensator, 0.0, {kMissing});
  EXPECT_EQ(before.flags, kStaleChannel | kNoChannelYet);
  EXPECT_EQ(before.compensated_radps[0], 0.0);
  EXPECT_EQ(step(compensator, 0.0, {35.0}).flags, 0U);
  const auto held = step(compensator, 0.0, {kMissing});
  EXPECT_EQ(held.flags, static_cast<std::uint32_t>(kStaleChannel));
  EXPECT_NEAR(held.compensated_radps[0], -1e-5, 1e-20);
  EXPECT_EQ(step(compensator, 0.0, {35.0}, 2.5).flags, static_cast<std::uint32_t>(kStaleChannel));
}

TEST(Compensator, VarianceIsThatOfTheParameters) {
  Model model;
  Effect quadratic = linear(1e-8);
  quadratic.form = "quadratic";
  model.effects = {linear(1e-6), quadratic};
  model.covariance = {4e-16, -1e-17, -1e-17, 9e-18};
  Compensator compensator(model, {""});
  const double c = 3.0;
  EXPECT_NEAR(step(compensator, 0.0, {28.0}).variance_rad2ps2[0],
              4e-16 * c * c - 2e-17 * c * c * c + 9e-18 * c * c * c * c, 1e-26);
}

TEST(Compensator, TakesOverTheStateOfTheModelBefore) {
  Model model;
  Effect lagged = linear(1e-6);
  lagged.form = "lagged";
  lagged.parameters.push_back({"lag_s", 100.0, 0.0, "s"});
  model.effects = {lagged};
  Compensator first(model, {""});
  step(first, 0.0, {25.0});
  for (int i = 0; i < 500; ++i) step(first, 0.0, {35.0});
  model.effects[0].parameters[0].value = 2e-6;
  Compensator second(model, {""});
  second.take_over(first);
  const double before = step(first, 0.0, {35.0}).correction_radps[0];
  EXPECT_NEAR(step(second, 0.0, {35.0}).correction_radps[0], 2.0 * before, 1e-18);
}

TEST(Compensator, LeavesOutWhatDoesNotCarryOver) {
  Model model;
  Effect step_effect;
  step_effect.form = "step";
  step_effect.parameters = {{"coefficient", 1.0, 0.0, "rad/s"}, {"time_s", 3.0, 0.0, "s"}};
  model.effects = {step_effect};
  Compensator compensator(model, {""});
  EXPECT_EQ(compensator.left_out(), std::vector<std::string>{"step"});
  EXPECT_EQ(step(compensator, 0.5, {}).compensated_radps[0], 0.5);
}

TEST(Compensator, RefusesAModelItCannotRun) {
  Model model;
  model.effects = {linear(1.0)};
  model.effects[0].form = "linaer";
  EXPECT_THROW(Compensator(model, {""}), std::invalid_argument);
  model.effects = {of_rate("rate", 1.0)};
  EXPECT_THROW(Compensator(model, {""}), std::invalid_argument);
  model.effects = {linear(1.0)};
  model.effects[0].axis = "y";
  EXPECT_THROW(Compensator(model, {""}), std::invalid_argument);
}

// A sensor that has long been on has nothing left to settle, and its samples do not say so in time.
TEST(Compensator, AWarmUpIsCorrectedOnlyWhereTheTimeSincePowerUpIsKnown) {
  Model model;
  Effect warm_up;
  warm_up.form = "warm_up";
  warm_up.parameters = {{"coefficient", 2e-6, 0.0, "rad/s"}, {"time_constant_s", 40.0, 0.0, "s"}};
  model.effects = {warm_up};
  Compensator unknown(model, {""});
  EXPECT_EQ(unknown.left_out(), std::vector<std::string>{"warm_up (the time since power-up is not known)"});
  EXPECT_EQ(step(unknown, 1e-3, {}).compensated_radps[0], 1e-3);
  for (const double since_s : {0.0, 25.0, 1e5}) {
    Compensator known(model, {""}, std::numeric_limits<double>::infinity(), since_s);
    EXPECT_TRUE(known.left_out().empty());
    for (int i = 0; i < 500; ++i) {
      const double settled = 2e-6 * std::exp(-(since_s + 0.01 * i) / 40.0);
      EXPECT_NEAR(step(known, 1e-3, {}).compensated_radps[0], 1e-3 - settled, 1e-17) << since_s << ' ' << i;
    }
  }
}

// A channel that stands still leaves a correction as it was; each that moves, at a rate of its own, changes
// its effects alone, on every axis that has them. The oracle is the model's own sum.
TEST(Compensator, EachEffectFollowsItsChannelAndNoOther) {
  Model model;
  Effect temperature = linear(2e-6), bent = linear(3e-8), acceleration = linear(5e-7), scale = linear(1e-3);
  bent.form = "quadratic";
  bent.axis = "y";
  acceleration.channel = "accel_x_mps2";
  acceleration.reference = 0.0;
  acceleration.axis = "x";
  scale.form = "product";
  scale.with_form = "linear";
  scale.with_channel = "reference_rate_radps";
  scale.axis = "z";
  model.effects = {temperature, bent, acceleration, scale};
  Compensator compensator(model, {"x", "y", "z"});
  ASSERT_EQ(compensator.channels(), (std::vector<std::string>{"temperature_degC", "accel_x_mps2"}));
  for (int i = 0; i < 400; ++i) {
    const double degC = 20.0 + 0.5 * (i / 37), mps2 = std::sin(i / 9), rate = 1e-3 * (i / 5);
    const CompensatorOutput out = step(compensator, rate, {degC, mps2});
    const double c = degC - 25.0;
    EXPECT_NEAR(out.correction_radps[0], 2e-6 * c + 5e-7 * mps2, 1e-18) << i;
    EXPECT_NEAR(out.correction_radps[1], 2e-6 * c + 3e-8 * c * c, 1e-18) << i;
    // z = w + b + k c w solved for the rate w.
    EXPECT_NEAR(out.compensated_radps[2], (rate - 2e-6 * c) / (1.0 + 1e-3 * c), 1e-15) << i;
    EXPECT_EQ(out.variance_rad2ps2, Axes{}) << i;
  }
}

}  // namespace
}  // namespace ifog
