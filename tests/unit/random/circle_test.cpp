// SPDX-License-Identifier: Apache-2.0
#include "filters/random/circle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

// Against the C library's, in all quarters and either way.
TEST(Circle, IsSineAndCosine) {
  for (int i = -4000; i <= 4000; ++i) {
    const double turns = i / 997.0;
    const ifog::OnCircle at = ifog::on_circle(turns);
    EXPECT_NEAR(at.sine, std::sin(2.0 * std::numbers::pi * turns), 3e-9) << turns;
    EXPECT_NEAR(at.cosine, std::cos(2.0 * std::numbers::pi * turns), 3e-9) << turns;
  }
}

}  // namespace
