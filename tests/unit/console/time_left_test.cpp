// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tools/ifog/console/progress.h"

namespace {

using ifog::tools::time_left;

TEST(TimeLeft, TheRestTakesAsLongAsWhatWasDoneTook) {
  EXPECT_EQ(time_left(10.0, 0.0, 1, 2), "10 s left");
  EXPECT_EQ(time_left(10.0, 0.0, 1, 3), "20 s left");
  EXPECT_EQ(time_left(10.0, 0.0, 90, 100), "2 s left");  // 1.1
}

TEST(TimeLeft, WhatHasGoneSinceTheLastStepIsTakenOff) {
  EXPECT_EQ(time_left(10.0, 4.0, 1, 2), "6 s left");
  EXPECT_EQ(time_left(10.0, 10.0, 1, 2), "");  // should have ended
  EXPECT_EQ(time_left(10.0, 25.0, 1, 2), "");
}

TEST(TimeLeft, IsToldAsExactlyAsItIsKnown) {
  EXPECT_EQ(time_left(61.0, 0.0, 1, 2), "65 s left");
  EXPECT_EQ(time_left(100.0, 0.0, 1, 2), "2 min left");
  EXPECT_EQ(time_left(600.0, 0.0, 1, 2), "10 min left");
  EXPECT_EQ(time_left(4800.0, 0.0, 1, 2), "1 h 20 min left");
  EXPECT_EQ(time_left(7200.0, 0.0, 1, 2), "2 h left");
}

TEST(TimeLeft, IsNotGuessedTooEarly) {
  EXPECT_EQ(time_left(1.5, 0.0, 1, 100), "");
  EXPECT_EQ(time_left(1.5, 0.6, 1, 100), "3 min left");  // 147.9 s
  EXPECT_EQ(time_left(1.5, 0.0, 10, 100), "14 s left");  // 13.5
  EXPECT_EQ(time_left(5.0, 0.0, 0, 100), "");
  EXPECT_EQ(time_left(5.0, 0.0, 100, 100), "");
  EXPECT_EQ(time_left(5.0, 0.0, 5, 0), "");
}

}  // namespace
