// SPDX-License-Identifier: Apache-2.0
// Which axes a fit can use.
#include "tools/ifog/captures/usable_axes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace ifog::tools {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Capture capture_of(std::size_t rows, const std::vector<std::string>& axes) {
  Capture out;
  for (std::size_t i = 0; i < rows; ++i) out.time_s.push_back(0.01 * static_cast<double>(i));
  for (std::size_t a = 0; a < axes.size(); ++a) {
    out.axes.push_back(axes[a]);
    out.reference_rate_radps.emplace_back();
    std::vector<double>& rate = out.rate_radps.emplace_back();
    for (std::size_t i = 0; i < rows; ++i) rate.push_back(std::sin(static_cast<double>(7 * i + a)));
  }
  return out;
}

std::vector<std::string> unusable(const Capture& capture) { return unusable_axes({capture}, {"a.csv"}); }

TEST(UsableAxes, OneThatRepeatsOneValueIsNotUsable) {
  Capture capture = capture_of(300, {"x", "y", "z"});
  EXPECT_TRUE(unusable(capture).empty());
  capture.rate_radps[1].assign(300, 1e-4);
  EXPECT_EQ(unusable(capture), (std::vector<std::string>{"y"}));
  capture.rate_radps[1][7] = kNone;
  EXPECT_EQ(unusable(capture), (std::vector<std::string>{"y"}));
  capture.rate_radps[1][299] = 2e-4;
  EXPECT_TRUE(unusable(capture).empty());
  capture.rate_radps[2].assign(300, kNone);
  EXPECT_EQ(unusable(capture), (std::vector<std::string>{"z"}));
}

// A coarse sensor at rest repeats itself.
TEST(UsableAxes, AFewEqualRowsSayNothing) {
  Capture capture = capture_of(100, {"x", "y"});
  capture.rate_radps[1].assign(100, 0.0);
  EXPECT_TRUE(unusable(capture).empty());
}

// What the command says of such rates is said of the whole capture.
TEST(UsableAxes, WhereNoOtherIsLeftAStuckOneStays) {
  Capture capture = capture_of(300, {"x", "y"});
  capture.rate_radps[0].assign(300, 0.0);
  capture.rate_radps[1].assign(300, 0.0);
  EXPECT_TRUE(unusable(capture).empty());
  capture.rate_radps[0].assign(300, kNone);
  EXPECT_EQ(unusable(capture), (std::vector<std::string>{"x"}));
  capture.rate_radps[1].assign(300, kNone);
  EXPECT_THROW(unusable(capture), std::runtime_error);
}

TEST(UsableAxes, OneOfSeveralCapturesLeavesItOutOfAll) {
  Capture one = capture_of(300, {"x", "y"}), other = one;
  one.rate_radps[1].assign(300, 0.0);
  std::vector<CaptureView> both{one, other};
  keep_usable_axes(both, {"a.csv", "b.csv"});
  for (const CaptureView& each : both) {
    EXPECT_EQ(each.axes, (std::vector<std::string>{"x"}));
    EXPECT_EQ(each.dead_axes, (std::vector<std::string>{"y"}));
  }
  other.rate_radps[0].assign(300, 0.0);
  both = {one, other};
  EXPECT_THROW(keep_usable_axes(both, {"a.csv", "b.csv"}), std::runtime_error);
}

}  // namespace
}  // namespace ifog::tools
