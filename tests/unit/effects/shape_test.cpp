// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/shape.h"
#include "filters/effects/compensator.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

ShapeSettings of(Form form, double tau = 0.0, double tau2 = 0.0) {
  ShapeSettings settings;
  settings.form = form;
  settings.reference = 25.0;
  settings.time_constant_s = tau;
  settings.second_time_constant_s = tau2;
  return settings;
}

TEST(Shape, PowersAreAboutTheReference) {
  EXPECT_DOUBLE_EQ(Shape(of(Form::kLinear)).step(27.0, 1.0), 2.0);
  EXPECT_DOUBLE_EQ(Shape(of(Form::kQuadratic)).step(22.0, 1.0), 9.0);
  EXPECT_DOUBLE_EQ(Shape(of(Form::kCubic)).step(23.0, 1.0), -8.0);
  EXPECT_DOUBLE_EQ(Shape(of(Form::kQuintic)).step(27.0, 1.0), 32.0);
  EXPECT_DOUBLE_EQ(Shape(of(Form::kSeptic)).step(27.0, 1.0), 128.0);
}

TEST(Shape, TheAbsoluteValueHasItsKinkAtTheReference) {
  const Shape shape(of(Form::kAbsolute));
  EXPECT_DOUBLE_EQ(shape.at(22.0), 3.0);
  EXPECT_DOUBLE_EQ(shape.at(29.0), 4.0);
  const Reach below = reach_of(10.0, {"t_degC", 20.0, 30.0});
  EXPECT_DOUBLE_EQ(shape.at(below), 15.0) << "a straight line on either side, and so beyond the edge";
  EXPECT_DOUBLE_EQ(shape.left_behind(below), 0.0);
}

TEST(Shape, ADeadZoneIsTheChannelWithinItsHalfWidth) {
  ShapeSettings settings;
  settings.form = Form::kDeadZone;
  settings.half_width = 0.5;
  const Shape zone(settings);
  EXPECT_DOUBLE_EQ(zone.at(0.3), 0.3);
  EXPECT_DOUBLE_EQ(zone.at(-0.49), -0.49);
  EXPECT_DOUBLE_EQ(zone.at(0.51), 0.0);
  settings.half_width = -1.0;
  EXPECT_THROW(Shape{settings}, std::invalid_argument);
}

// The response of a first-order lag to a step is 1 - exp(-t/tau), exactly at the sample times.
TEST(Shape, LagAnswersAStepExponentially) {
  Shape lag(of(Form::kLagged, 40.0));
  lag.step(25.0, 0.5);
  for (int k = 1; k <= 400; ++k) {
    EXPECT_NEAR(lag.step(35.0, 0.5), 10.0 * (1.0 - std::exp(-0.5 * k / 40.0)), 1e-12);
  }
}

TEST(Shape, DerivativeOfASlopeIsTheSlopeAtAnyBandwidth) {
  for (const double tau : {0.0, 0.3, 20.0}) {
    Shape rate(of(Form::kRate, tau));
    Shape second(of(Form::kSecondRate, tau));
    double slope = 0.0;
    double curve = 0.0;
    for (int k = 0; k < 20000; ++k) {
      const double t = 0.1 * k;
      slope = rate.step(20.0 + 0.003 * t, 0.1);
      curve = second.step(20.0 + 0.5 * 0.002 * t * t, 0.1);
    }
    EXPECT_NEAR(slope, 0.003, 1e-12) << tau;
    EXPECT_NEAR(curve, 0.002, 1e-9) << tau;
  }
}

// High-pass gain at a frequency far above the corner is one, so the mean square is a^2 / 2.
TEST(Shape, BandPowerIsTheMeanSquareOfTheFastPart) {
  Shape power(of(Form::kBandPower, 5.0));
  double sum = 0.0;
  for (int k = 0; k < 40000; ++k) {
    const double value = power.step(30.0 + 0.2 * std::sin(2.0 * std::numbers::pi * 12.5 * 0.001 * k), 0.001);
    if (k >= 30000) sum += value;
  }
  EXPECT_NEAR(sum / 10000.0, 0.02, 2e-4);
}

// Where a machine starts the power goes as a first-order lag does, whether each sample is looked at or the
// scatter of a step of them.
TEST(Shape, BandPowerIsAveragedByItsOwnTimeConstant) {
  for (const double average : {0.0, 0.4, 2.5}) {
    Shape by_step(of(Form::kBandPower, 1000.0, average)), by_sample(of(Form::kBandPower, 1000.0, average));
    const double tau = average > 0.0 ? average : 1.0;
    for (int k = 0; k < 4000; ++k) {
      const double a = k < 1000 ? 0.0 : 0.3;
      double last = 0.0;
      for (int i = 0; i < 10; ++i) last = by_sample.step(25.0 + (i % 2 ? a : -a), 0.001);
      const double value = by_step.step_over(25.0, a * a, 0.01);
      const double t = 0.01 * (k - 999);
      const double lagged = k < 1000 ? 0.0 : 0.09 * -std::expm1(-t / tau);
      EXPECT_NEAR(value, lagged, 1e-6) << k;
      EXPECT_NEAR(last, lagged, 1e-4) << k;
    }
  }
}

// A record begins at any phase of the vibration; its mean is what the slow low-pass has to begin at.
TEST(Shape, BandPowerOfASlowBandDoesNotRememberItsFirstSample) {
  ShapeSettings settings = of(Form::kBandPower, 100.0);
  settings.begins_at_mean = true;
  Shape power(settings);
  double value = 0.0;
  for (int k = 0; k < 8000; ++k)
    value = power.step(30.0 + 0.2 * std::cos(2.0 * std::numbers::pi * 12.5 * 0.001 * k), 0.001);
  EXPECT_NEAR(value, 0.02, 1e-3);
}

TEST(Shape, LookupIsLinearBetweenKnotsAndPeriodic) {
  ShapeSettings settings = of(Form::kLookup);
  settings.table_x = {0.0, 10.0, 30.0, 40.0};
  settings.table_y = {1.0, 2.0, -2.0, 0.0};
  Shape flat(settings);
  EXPECT_DOUBLE_EQ(flat.step(20.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(flat.step(-5.0, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(flat.step(55.0, 1.0), 0.0);
  settings.period = 40.0;
  Shape periodic(settings);
  EXPECT_DOUBLE_EQ(periodic.step(45.0, 1.0), 1.5);
  EXPECT_DOUBLE_EQ(periodic.step(-35.0, 1.0), 1.5);
}

// The sum of an angle's differences is bounded by the table whatever the channel does: it cannot swallow
// rotation.
TEST(Shape, AngleLookupIntegratesToItsTable) {
  ShapeSettings settings = of(Form::kLookup);
  settings.table_x = {0.0, 16384.0, 32768.0};
  settings.table_y = {0.0, 4e-9, 1e-9};
  settings.period = 32768.0;
  settings.angle = true;
  Shape shape(settings);
  double angle = 0.0;
  for (int k = 0; k < 100000; ++k) {
    angle += shape.step(std::fmod(70001.0 * k, 32768.0), 0.005) * 0.005;
    ASSERT_LE(std::abs(angle), 4e-9 * (1.0 + 1e-9));
  }
}

// A bias that ages, and one that goes from one level to another: by their closed forms.

constexpr double kSlope = 2e-9;  // rad/s^2

Model ageing() {
  Model model;
  Effect ramp;
  ramp.form = "rate_ramp";
  ramp.parameters = {{"coefficient", kSlope, 1e-10, "rad/s^2"}};
  model.effects = {ramp};
  model.ranges = {{"time_s", 0.0, 100.0}};
  return model;
}

CompensatorOutput step_of(Compensator& compensator, double dt_s, std::vector<double> channels = {}) {
  CompensatorInput in;
  in.dt_s = dt_s;
  in.channels = channels;
  CompensatorOutput out;
  compensator.step(in, out);
  return out;
}

// It counts from the first sample, is extrapolated for as long again as it was fitted, then held, with a flag.
TEST(Ageing, ASlopeGoesOnForOneMoreSpan) {
  Compensator compensator(ageing(), {""});
  EXPECT_TRUE(compensator.channels().empty());
  EXPECT_TRUE(compensator.left_out().empty());
  double before = -1.0;
  for (int i = 0; i <= 300; ++i) {
    const CompensatorOutput out = step_of(compensator, 1.0);
    EXPECT_NEAR(out.correction_radps[0], kSlope * std::min(i, 200), 1e-15) << i;
    EXPECT_EQ((out.flags & kOutOfRange) != 0, i > 100) << i;
    if (i > 200) {
      EXPECT_GT(out.variance_rad2ps2[0], before) << i;
    }
    before = out.variance_rad2ps2[0];
  }
}

TEST(Ageing, AGapIsPartOfTheTime) {
  Compensator compensator(ageing(), {""});
  step_of(compensator, 1.0);
  EXPECT_NEAR(step_of(compensator, 60.0).correction_radps[0], 60.0 * kSlope, 1e-18);
}

TEST(Ageing, WithoutTheTimeItWasFittedItIsLeftOut) {
  Model model = ageing();
  model.ranges.clear();
  Compensator compensator(model, {""});
  EXPECT_EQ(compensator.left_out().size(), 1U);
  step_of(compensator, 1.0);
  EXPECT_EQ(step_of(compensator, 1.0).correction_radps[0], 0.0);
}

TEST(Ageing, AReloadGoesOnWhereItWas) {
  Compensator first(ageing(), {""});
  for (int i = 0; i < 50; ++i) step_of(first, 1.0);
  Compensator second(ageing(), {""});
  second.take_over(first);
  EXPECT_NEAR(step_of(second, 1.0).correction_radps[0], 50.0 * kSlope, 1e-18);
}

Effect transition(double half_width) {
  Effect effect;
  effect.form = "transition";
  effect.channel = "temperature_degC";
  effect.reference = 31.0;
  effect.parameters = {{"coefficient", 4e-7, 0.0, "rad/s"}, {"half_width", half_width, 0.0, "degC"}};
  return effect;
}

TEST(Transition, EndsAtItsLevelsWhereverTheChannelGoes) {
  Model model;
  model.effects = {transition(3.0)};
  model.ranges = {{"temperature_degC", 25.0, 36.0}};
  Compensator compensator(model, {""});
  for (const double at : {-190.0, 10.0, 27.0, 31.0, 34.5, 40.0, 230.0}) {
    const CompensatorOutput out = step_of(compensator, 0.1, {at});
    EXPECT_NEAR(out.correction_radps[0], 4e-7 * std::tanh((at - 31.0) / 3.0), 1e-20) << at;
    EXPECT_EQ((out.flags & kOutOfRange) != 0, at < 25.0 || at > 36.0) << at;
    // The farther of its two levels was not seen: no more than that may be wrong.
    EXPECT_LE(out.variance_rad2ps2[0], std::pow(8e-7, 2)) << at;
  }
}

TEST(Transition, OfNoWidthIsRefused) {
  Model model;
  model.effects = {transition(0.0)};
  EXPECT_THROW(Compensator(model, {""}), std::invalid_argument);
}

}  // namespace
}  // namespace ifog
