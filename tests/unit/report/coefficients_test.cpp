// SPDX-License-Identifier: Apache-2.0
#include "tools/report/coefficients.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

TEST(Coefficients, APrintedBoundIsNeverBelowTheBound) {
  for (double upper = 1.003e-9; upper < 1e9; upper *= 1.0371) {
    const double printed = std::strtod(ifog::report::bound_text(upper).c_str(), nullptr);
    EXPECT_GE(printed, upper);
    EXPECT_LE(printed, 1.1 * upper);
  }
  EXPECT_EQ(ifog::report::bound_text(0.0), "0");
  EXPECT_EQ(ifog::report::bound_text(0.25), "0.25");
  EXPECT_EQ(ifog::report::bound_text(0.2501), "0.26");
  EXPECT_EQ(ifog::report::bound_text(9.91), "10");
}

TEST(Coefficients, ATermIsToldWithItsErrorOrItsBound) {
  ifog::NoiseCoefficients found;
  found.N = {true, 2.9088820866572159e-4, 2.9088820866572159e-6, 3e-4, 9.0};  // 1 °/√h and a hundredth of it
  found.B.upper = 4.8481368110953599e-6;                                      // 1 °/h
  const std::string lines = ifog::report::coefficient_lines(found);
  EXPECT_NE(lines.find("1 ± 0.01"), std::string::npos) << lines;
  EXPECT_NE(lines.find("not seen; below 1 °/h\n"), std::string::npos) << lines;
  const auto json = ifog::report::coefficients_json(found);
  EXPECT_TRUE(json["N"]["present"]);
  EXPECT_FALSE(json["K"]["present"]);
}

}  // namespace
