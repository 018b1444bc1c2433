// SPDX-License-Identifier: Apache-2.0
// A bias that ages, and one that goes from one level to another: by their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "filters/effects/compensator.h"

namespace ifog {
namespace {

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
