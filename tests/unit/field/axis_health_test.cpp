// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/axis_health.h"

#include <gtest/gtest.h>

namespace ifog::tools {
namespace {

TEST(AxisHealth, AnAxisThatHasHadNoValueIsNoneOfInnovationsOfNothing) {
  EXPECT_EQ(axis_health({0.97, 0.0, 1.5}, {0.012, 0.0, -0.3}),
            "x NIS 0.970, whiteness +0.012; y no value; z NIS 1.500, whiteness -0.300");
  EXPECT_EQ(axis_health({1.0}, {0.0}), "rate NIS 1.000, whiteness +0.000");
  EXPECT_EQ(axis_health({0.0}, {0.0}), "rate no value");
}

}  // namespace
}  // namespace ifog::tools
