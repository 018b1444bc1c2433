// SPDX-License-Identifier: Apache-2.0
// What a comb and a table of a feedback ramp are made of, against their formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "filters/diagnosis/ramp/carrier.h"
#include "filters/diagnosis/ramp/ramp_comb.h"
#include "filters/diagnosis/ramp/ramp_table.h"

namespace ifog {
namespace {

UnbrokenPart turning(std::size_t samples, double turn_rad) {
  UnbrokenPart part;
  part.sample_s = 0.01;
  part.error_radps.assign(samples, 0.0);
  for (std::size_t i = 0; i < samples; ++i) part.angle_rad.push_back(turn_rad * static_cast<double>(i));
  return part;
}

TEST(Carrier, IsOneTurnACycle) {
  for (const double whole : {-3.0, 0.0, 1048576.0}) {
    EXPECT_NEAR(std::abs(carrier_of(whole) - 1.0), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(carrier_of(whole + 0.25) - std::complex<double>(0.0, 1.0)), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(carrier_of(whole + 0.5) + 1.0), 0.0, 1e-12);
  }
}

TEST(RampComb, OfAConstantRateTheMeanAngleIsTheAngle) {
  const UnbrokenPart part = turning(5000, -2e-6);
  const std::vector<double> even = evenly_turned(part);
  ASSERT_EQ(even.size(), part.size());
  for (std::size_t i = 0; i < even.size(); ++i) EXPECT_NEAR(even[i], part.angle_rad[i], 1e-12);
}

// Below half the sample rate a cycle turns less than 0.5/k, and near zero rate none is seen.
TEST(RampComb, ShowsCyclesBelowHalfTheSampleRate) {
  const double turn = 2e-6;
  const VisibleCycles visible = visible_cycles(turning(100000, turn));
  EXPECT_LT(visible.least, visible.most);
  EXPECT_LT(visible.most * turn, 0.5);
  EXPECT_GE(visible.least, kLeastCycles);
  EXPECT_GE(visible.least * turn * 100000.0, 20.0);
  const VisibleCycles turned_back = visible_cycles(turning(100000, -turn));
  EXPECT_NEAR(turned_back.most, visible.most, 1e-6 * visible.most);
  const VisibleCycles none = visible_cycles(turning(100000, 0.0));
  EXPECT_GT(none.least, none.most);
}

TEST(RampTable, EachPartIsFourPiecesOfTheRecord) {
  std::array<std::size_t, kRampParts> count{};
  std::size_t changes = 0;
  for (std::size_t i = 0; i < 1600; ++i) {
    ++count.at(ramp_part(i, 1600));
    changes += i > 0 && ramp_part(i, 1600) != ramp_part(i - 1, 1600) ? 1 : 0;
  }
  for (const std::size_t each : count) EXPECT_EQ(each, 400U);
  EXPECT_EQ(changes, 15U);
}

TEST(RampTable, ACycleIsTheSumOfItsHarmonics) {
  RampTable table;
  table.cycles_per_rad = 2e5;
  table.harmonics = Eigen::Vector4d(2.0, 0.0, 0.5, -1.0);
  table.harmonics_without[1] = Eigen::Vector4d::Zero();
  const std::vector<double> cycle = table.one_cycle();
  ASSERT_EQ(cycle.size(), 8U);
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    const double a = std::numbers::pi / 4.0 * static_cast<double>(i);
    EXPECT_NEAR(cycle[i], 2.0 * std::cos(a) + 0.5 * std::cos(2.0 * a) - std::sin(2.0 * a), 1e-12);
  }
  EXPECT_EQ(table.settings().cycles_per_rad, 2e5);
  EXPECT_EQ(table.settings().angle_rad, cycle);
  const std::vector<double> without = table.without(1).one_cycle();
  EXPECT_TRUE(std::all_of(without.begin(), without.end(), [](double value) { return value == 0.0; }));
}

}  // namespace
}  // namespace ifog
