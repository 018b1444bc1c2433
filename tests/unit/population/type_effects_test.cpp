// SPDX-License-Identifier: Apache-2.0
#include "filters/population/type_effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace ifog {
namespace {

Effect effect(const std::string& form, const std::string& channel, double lag_s = 0.0,
              const std::string& axis = "") {
  Effect made;
  made.form = form;
  made.channel = channel;
  made.axis = axis;
  made.parameters = {{"coefficient", 1.0, 0.1, "rad/s"}};
  if (lag_s > 0.0) made.parameters.push_back({"lag_s", lag_s, 1.0, "s"});
  return made;
}

// The binomial's tail, term by term.
double tail(std::size_t n, double p, std::size_t least) {
  double sum = 0.0;
  for (std::size_t k = least; k <= n; ++k) {
    const auto x = static_cast<double>(k), m = static_cast<double>(n);
    sum += std::exp(std::lgamma(m + 1) - std::lgamma(x + 1) - std::lgamma(m - x + 1) + x * std::log(p) +
                    (m - x) * std::log1p(-p));
  }
  return sum;
}

TEST(TypeEffects, SoManyFalseAlarmsHappenOnceInAHundredTypes) {
  for (const std::size_t gyros : {1U, 2U, 10U, 40U, 200U, 1000U}) {
    const std::size_t least = least_repeats(gyros, 0.01);
    EXPECT_LE(tail(gyros, 0.01, least), 0.01 + 1e-12) << gyros;
    EXPECT_GT(tail(gyros, 0.01, least - 1), 0.01) << gyros;
  }
}

TEST(TypeEffects, FormsOfOneChannelStandForEachOther) {
  std::vector<FoundInGyro> found;
  for (std::size_t i = 0; i < 6; ++i)
    found.push_back({i, effect("lagged", "t_degC", 100.0 + 20.0 * static_cast<double>(i))});
  for (std::size_t i = 6; i < 9; ++i) found.push_back({i, effect("linear", "t_degC")});
  found.push_back({9, effect("linear", "supply_V")});
  const auto candidates = type_candidates(found, 20, 0.01);
  ASSERT_EQ(candidates.size(), 1U);
  EXPECT_EQ(candidates[0].found_in, 9U);
  ASSERT_EQ(candidates[0].forms.size(), 2U);
  EXPECT_EQ(candidates[0].forms[0].form, "lagged");
  // The middle of 100 120 140 160 180 200, by the logarithm.
  ASSERT_EQ(candidates[0].forms[0].parameters.size(), 2U);
  EXPECT_NEAR(candidates[0].forms[0].parameters[1].value, std::sqrt(140.0 * 160.0), 1e-9);
  EXPECT_EQ(candidates[0].forms[0].parameters[0].value, 0.0);
  EXPECT_TRUE(is_of(candidates[0], effect("linear", "t_degC")));
  EXPECT_FALSE(is_of(candidates[0], effect("linear", "supply_V")));
  EXPECT_FALSE(is_of(candidates[0], effect("linear", "t_degC", 0.0, "y")));
}

TEST(TypeEffects, FormsThatGyrosShowTogetherAreTwoEffects) {
  std::vector<FoundInGyro> found;
  for (std::size_t i = 0; i < 8; ++i) found.push_back({i, effect("linear", "t_degC")});
  for (std::size_t i = 4; i < 10; ++i) found.push_back({i, effect("quadratic", "t_degC")});
  EXPECT_EQ(type_candidates(found, 20, 0.01).size(), 2U);
}

TEST(TypeEffects, AxesAreApartAndEventsAreNobodys) {
  std::vector<FoundInGyro> found;
  for (std::size_t i = 0; i < 8; ++i) {
    found.push_back({i, effect("linear", "t_degC", 0.0, i % 2 == 0 ? "x" : "y")});
    found.push_back({i, effect("step", "")});
    found.push_back({i, effect("lookup", "ramp_counts")});
  }
  EXPECT_EQ(type_candidates(found, 10, 0.01).size(), 2U);
  // Two of a thousand gyros are what false alarms make.
  EXPECT_TRUE(
      type_candidates(std::vector<FoundInGyro>(found.begin(), found.begin() + 4), 1000, 0.01).empty());
}

TEST(TypeEffects, AGyroCountsOnce) {
  const std::vector<FoundInGyro> found{{3, effect("linear", "t_degC")}, {3, effect("linear", "t_degC")}};
  EXPECT_TRUE(type_candidates(found, 5, 0.01).empty());
}

}  // namespace
}  // namespace ifog
