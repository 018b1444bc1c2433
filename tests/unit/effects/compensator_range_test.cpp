// SPDX-License-Identifier: Apache-2.0
// What is taken away outside the ranges that a model was fitted in, and how much its variance owns to.
#include "tests/unit/effects/compensated.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// 30 degrees wide, from 10 to 40: on for 30 more on each side, then held.
Model fitted_from_10_to_40(const char* form, double coefficient, double error) {
  Model model;
  model.effects = {linear(coefficient)};
  model.effects[0].form = form;
  model.effects[0].parameters[0].std_error = error;
  model.covariance = {error * error};
  model.ranges = {{"temperature_degC", 10.0, 40.0}};
  return model;
}

TEST(Compensator, ALinearEffectGoesOnForOneMoreSpanAndIsThenHeld) {
  Compensator compensator(fitted_from_10_to_40("linear", 1e-6, 0.0), {""});
  EXPECT_EQ(step(compensator, 0.0, {39.0}).flags, 0U);
  for (const double t : {-60.0, -20.0, 0.0, 45.0, 70.0, 200.0}) {
    const auto out = step(compensator, 0.0, {t});
    const double followed = std::clamp(t, 10.0 - 30.0, 40.0 + 30.0);
    EXPECT_EQ(out.flags, static_cast<std::uint32_t>(kOutOfRange)) << t;
    EXPECT_NEAR(out.correction_radps[0], 1e-6 * (followed - 25.0), 1e-18) << t;
    EXPECT_NEAR(out.variance_rad2ps2[0], std::pow(1e-6 * (t - followed), 2), 1e-18) << t;
  }
}

// Three quarters of a turn seen, over the wrap: from 3 rad to 3 + 3 pi / 2.
TEST(Compensator, WhatRepeatsWithAnAngleIsHeldAtTheNearerEndOfItsArc) {
  const double low = 3.0, high = low + 1.5 * M_PI;
  for (const double times : {1.0, 2.0}) {
    Model model;
    model.effects = {linear(1e-6)};
    model.effects[0].form = "cosine";
    model.effects[0].channel = "table_rad";
    model.effects[0].reference = 0.0;
    model.effects[0].period = 2.0 * M_PI / times;
    model.ranges = {{"table_rad", low, high}};
    Compensator compensator(model, {""});
    for (double angle = -7.0; angle < 20.0; angle += 0.37) {
      const double into = std::remainder(angle - low - 0.75 * M_PI, 2.0 * M_PI);  // from its middle
      const double held = low + 0.75 * M_PI + std::clamp(into, -0.75 * M_PI, 0.75 * M_PI);
      const auto out = step(compensator, 0.0, {angle});
      EXPECT_NEAR(out.correction_radps[0], 1e-6 * std::cos(times * held), 1e-15) << angle;
      EXPECT_EQ(out.flags, std::abs(into) > 0.75 * M_PI ? static_cast<std::uint32_t>(kOutOfRange) : 0U);
    }
  }
}

// A fringe in temperature is a law, not an angle: beyond its range it is extrapolated by one more span, then
// held, with a flag.
TEST(Compensator, AFringeGoesOnForOneMoreSpan) {
  Model model = fitted_from_10_to_40("cosine", 1e-6, 0.0);
  model.effects[0].period = 7.0;
  Compensator compensator(model, {""});
  for (const double t : {12.0, 39.0, 45.0, 69.0, 85.0, -15.0, -30.0}) {
    const auto out = step(compensator, 0.0, {t});
    const double followed = std::clamp(t, -20.0, 70.0) - 25.0;
    EXPECT_NEAR(out.correction_radps[0], 1e-6 * std::cos(2.0 * M_PI * followed / 7.0), 1e-15) << t;
    EXPECT_EQ(out.flags, t < 10.0 || t > 40.0 ? static_cast<std::uint32_t>(kOutOfRange) : 0U) << t;
  }
}

TEST(Compensator, AHigherPowerGoesOnByItsTangent) {
  Compensator compensator(fitted_from_10_to_40("cubic", 1e-8, 0.0), {""});
  const auto out = step(compensator, 0.0, {50.0});
  const double tangent = 15.0 * 15.0 * 15.0 + 3.0 * 15.0 * 15.0 * 10.0;
  EXPECT_NEAR(out.correction_radps[0], 1e-8 * tangent, 1e-16);
  EXPECT_NEAR(out.variance_rad2ps2[0], std::pow(1e-8 * (25.0 * 25.0 * 25.0 - tangent), 2), 1e-16);
}

TEST(Compensator, AWellKnownCurveGoesOnAsItIsForOneMoreSpan) {
  for (const auto& [form, power] : {std::pair{"quadratic", 2}, {"cubic", 3}}) {
    Model model = fitted_from_10_to_40(form, 1e-8, 0.0);
    model.effects[0].parameters.push_back({"curve_reach", 30.0, 0.0, "degC"});
    model.covariance.assign(4, 0.0);
    Compensator compensator(model, {""});
    for (const double t : {0.0, 50.0, 70.0, 90.0}) {
      const auto out = step(compensator, 0.0, {t});
      const double c = std::min(t, 70.0) - 25.0;
      EXPECT_NEAR(out.correction_radps[0], 1e-8 * std::pow(c, power), 1e-16) << form << ' ' << t;
      const double held = t > 70.0 ? 1e-8 * power * std::pow(c, power - 1) * (t - 70.0) : 0.0;
      EXPECT_NEAR(out.variance_rad2ps2[0], held * held, 1e-18) << form << ' ' << t;
    }
  }
}

// An even spread over the zone has a third of the square of its half width; nothing is given back.
TEST(Compensator, WhatADeadZoneHidesIsInTheVariance) {
  Model model;
  model.effects = {of_rate("dead_zone", -1.0)};
  model.effects[0].reference = 2e-6;
  model.effects[0].parameters.push_back({"half_width", 1e-4, 0.0, "rad/s"});
  Compensator compensator(model, {""});
  EXPECT_EQ(compensator.left_out().size(), 1U);
  const auto inside = step(compensator, 9e-5, {});
  EXPECT_EQ(inside.correction_radps[0], 0.0);
  EXPECT_NEAR(inside.variance_rad2ps2[0], 1e-8 / 3.0, 1e-16);
  EXPECT_EQ(step(compensator, 1.03e-4, {}).variance_rad2ps2[0], 0.0);
  model.effects[0].channel = "temperature_degC";
  EXPECT_THROW(Compensator(model, {""}), std::invalid_argument);
}

TEST(Compensator, OfAProductBothFactorsGoOn) {
  Model model = fitted_from_10_to_40("product", 1e-6, 0.0);
  model.effects[0].with_form = "linear";
  model.effects[0].with_channel = "supply_V";
  model.effects[0].with_reference = 12.0;
  model.ranges.push_back({"supply_V", 11.0, 13.0});
  Compensator compensator(model, {""});
  const auto out = step(compensator, 0.0, {45.0, 14.5});
  EXPECT_NEAR(out.correction_radps[0], 1e-6 * 20.0 * 2.5, 1e-18);
  EXPECT_NEAR(step(compensator, 0.0, {45.0, 19.0}).correction_radps[0], 1e-6 * 20.0 * 3.0, 1e-18);
}

TEST(Compensator, ALookedUpEffectIsHeldAtTheEdge) {
  Model model = fitted_from_10_to_40("lookup", 1.0, 0.0);
  model.effects[0].parameters.clear();
  model.covariance.clear();
  model.effects[0].table_x = {10.0, 20.0, 40.0};
  model.effects[0].table_y = {0.0, 1e-6, 5e-6};
  Compensator compensator(model, {""});
  const auto out = step(compensator, 0.0, {50.0});
  EXPECT_NEAR(out.correction_radps[0], 5e-6, 1e-18);
  EXPECT_NEAR(out.variance_rad2ps2[0], std::pow(2e-7 * 10.0, 2), 1e-24);
}

// Second method: many records of a gyro that is truly linear in a channel evenly spread over the range, each
// fitted with a line and a parabola. As far as the parabola cannot be excluded the line may be wrong outside.
TEST(Compensator, OutsideTheVarianceHoldsTheCurvatureThatTheFitCouldNotExclude) {
  constexpr int kSamples = 2001;
  constexpr double kSpan = 30.0, kSigma = 1e-6;
  double xx = 0.0, pp = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = kSpan * (static_cast<double>(i) / (kSamples - 1) - 0.5);
    const double parabola = x * x - kSpan * kSpan / 12.0;
    xx += x * x;
    pp += parabola * parabola;
  }
  const double line_error = kSigma / std::sqrt(xx), parabola_error = kSigma / std::sqrt(pp);
  Compensator compensator(fitted_from_10_to_40("linear", 1e-6, line_error), {""});
  for (const double past : {3.0, 15.0, 30.0}) {
    const double x = kSpan / 2.0 + past;
    const double grown = (x * x - kSpan * kSpan / 4.0) * parabola_error;
    const double expected = std::pow(line_error * (15.0 + past), 2) + grown * grown;
    EXPECT_NEAR(step(compensator, 0.0, {40.0 + past}).variance_rad2ps2[0], expected, 0.01 * expected) << past;
  }
}

TEST(Compensator, BeyondTheRatesOfTheFitTheScaleFactorGoesOn) {
  Model model;
  model.effects = {of_rate("linear", 0.01)};
  model.ranges = {{"reference_rate_radps", -1.0, 1.0}};
  Compensator compensator(model, {"z"});
  EXPECT_NEAR(step(compensator, 2.0 * 1.01, {}).compensated_radps[0], 2.0, 1e-12);
  EXPECT_EQ(step(compensator, 2.0 * 1.01, {}).flags, static_cast<std::uint32_t>(kOutOfRange));
  EXPECT_NEAR(step(compensator, 10.0 + 0.03, {}).compensated_radps[0], 10.0, 1e-12);  // held at three
}

// Outside the range of the fit a correction is doubted for as long as the channel is there, and no longer.
TEST(Compensator, TheDoubtOutsideARangeStaysAndGoesWithTheChannel) {
  Model model;
  Effect bent = linear(3e-6);
  bent.form = "quadratic";
  model.effects = {bent};
  model.ranges = {{"temperature_degC", 20.0, 30.0}};
  Compensator compensator(model, {"x", "y", "z"});
  for (int i = 0; i < 60; ++i) {
    const double degC = i / 10 % 2 == 0 ? 26.0 : 33.0;
    const CompensatorOutput out = step(compensator, 1e-3, {degC});
    // A square follows its tangent at the edge; beyond it, (33 - 30)^2 is left.
    const double left = degC > 30.0 ? 3e-6 * 9.0 : 0.0;
    for (const double variance : out.variance_rad2ps2) EXPECT_NEAR(variance, left * left, 1e-22) << i;
    EXPECT_EQ((out.flags & kOutOfRange) != 0, degC > 30.0) << i;
  }
}

}  // namespace
}  // namespace ifog
