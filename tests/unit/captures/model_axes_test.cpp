// SPDX-License-Identifier: Apache-2.0
// A model of three axes on a capture that has two of them.
#include "tools/ifog/captures/model_axes.h"

#include <gtest/gtest.h>

namespace ifog::tools {
namespace {

Effect effect(const std::string& axis, const std::string& channel, std::size_t parameters) {
  Effect out;
  out.form = "linear";
  out.axis = axis;
  out.channel = channel;
  for (std::size_t i = 0; i < parameters; ++i)
    out.parameters.push_back({i == 0 ? "coefficient" : "other", 1.0, 0.1, ""});
  return out;
}

// Each number of the covariance says where it stood.
Model three() {
  Model model;
  model.effects = {effect("x", "temperature_degC", 1), effect("y", "temperature_degC", 2),
                   effect("z", "rate_y_radps", 1), effect("z", "supply_V", 2)};
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) model.covariance.push_back(10.0 * row + column);
  return model;
}

TEST(ModelAxes, EffectsOfAnAxisAndOnItsRateGoWithTheirCovariance) {
  const Model left = without_axes(three(), {"y"});
  ASSERT_EQ(left.effects.size(), 2U);
  EXPECT_EQ(left.effects[0].axis, "x");
  EXPECT_EQ(left.effects[1].channel, "supply_V");
  EXPECT_EQ(left.covariance, (std::vector<double>{0, 4, 5, 40, 44, 45, 50, 54, 55}));
}

TEST(ModelAxes, WithoutAnythingToLeaveOutItStaysAsItIs) {
  EXPECT_EQ(without_axes(three(), {}).identity(), three().identity());
  EXPECT_EQ(without_axes(three(), {"w"}).identity(), three().identity());
  EXPECT_EQ(without_axes(three(), {""}).identity(), three().identity());
}

}  // namespace
}  // namespace ifog::tools
