// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/normal_equations.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ifog {
namespace {

// X'X of a line at 0, 1, 2, 3 in units that make its columns differ by 1e12, and y = 1, 2, 4, 4: level and
// slope are 1.1, worked out by hand.
constexpr double kUnit = 1e12;

NormalEquations line() {
  Eigen::Matrix3d gram;
  gram << 37.0, 11.0, 22.0 * kUnit,  //
      11.0, 4.0, 6.0 * kUnit,        //
      22.0 * kUnit, 6.0 * kUnit, 14.0 * kUnit * kUnit;
  return NormalEquations::of_measured_first(gram);
}

TEST(NormalEquations, OfALineInWildUnits) {
  const Eigen::VectorXd c = line().coefficients();
  EXPECT_NEAR(c[0], 1.1, 1e-13);
  EXPECT_NEAR(c[1] * kUnit, 1.1, 1e-13);
  EXPECT_NEAR(line().explained(), 1.1 * 11.0 + 1.1 * 22.0, 1e-12);
}

// The inverse of (4 6; 6 14) is (14 -6; -6 4) / 20, its determinant 20.
TEST(NormalEquations, InverseAndDeterminantOfALine) {
  const Eigen::MatrixXd inverse = line().inverse();
  EXPECT_NEAR(inverse(0, 0), 0.7, 1e-13);
  EXPECT_NEAR(inverse(0, 1) * kUnit, -0.3, 1e-13);
  EXPECT_NEAR(inverse(1, 1) * kUnit * kUnit, 0.2, 1e-13);
  EXPECT_NEAR(line().log_determinant(), std::log(20.0) + 2.0 * std::log(kUnit), 1e-12);
}

// What is known beforehand is on the diagonal: one column of squared length 4, known to 1/√12 about 0.
TEST(NormalEquations, TakeWhatIsKnownBeforehand) {
  const NormalEquations known(Eigen::MatrixXd::Constant(1, 1, 4.0 + 12.0), Eigen::VectorXd::Constant(1, 8.0));
  EXPECT_NEAR(known.coefficients()[0], 0.5, 1e-15);
}

TEST(NormalEquations, OfAColumnOfNothingAreFinite) {
  const NormalEquations nothing(Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Zero(1));
  EXPECT_EQ(nothing.coefficients()[0], 0.0);
  EXPECT_EQ(nothing.explained(), 0.0);
  EXPECT_TRUE(std::isfinite(nothing.log_determinant()));
}

}  // namespace
}  // namespace ifog
