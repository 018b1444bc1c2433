// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/least_squares.h"

#include <gtest/gtest.h>

namespace ifog {
namespace {

// A straight line through four points; the closed form of its slope and level.
TEST(LeastSquares, IsTheClosedFormOfALine) {
  Columns x(4, 2);
  x << 1, 0, 1, 1, 1, 2, 1, 3;
  const Eigen::Vector4d y(1.0, 2.0, 4.0, 4.0);
  const LeastSquares line(x);
  EXPECT_EQ(line.rank(), 2);
  const Eigen::VectorXd c = line.coefficients(y);
  EXPECT_NEAR(c[0], 1.1, 1e-14);
  EXPECT_NEAR(c[1], 1.1, 1e-14);
  const Eigen::Vector4d left(-0.1, -0.2, 0.7, -0.4);
  EXPECT_LT((left_by(x, y) - left).norm(), 1e-14);
}

TEST(LeastSquares, OfDependentColumnsExplainsWhatTheyExplain) {
  Columns x(3, 3);
  x << 1, 2, 3, 0, 1, 1, 0, 0, 0;  // the third is the sum of the others
  const Eigen::Vector3d y(5.0, 1.0, 7.0);
  EXPECT_EQ(LeastSquares(x).rank(), 2);
  EXPECT_LT((left_by(x, y) - Eigen::Vector3d(0, 0, 7)).norm(), 1e-14);
}

// Twice the same column: the minimum of a² + b² under a + b = 6 is at 3 and 3.
TEST(ShortestCoefficients, AreSharedByColumnsThatAreAlike) {
  Eigen::MatrixXd x(3, 2);
  x << 1, 1, 0, 0, 1, 1;
  const Eigen::VectorXd c = shortest_coefficients(x, Eigen::Vector3d(6, 1, 6));
  EXPECT_NEAR(c[0], 3.0, 1e-14);
  EXPECT_NEAR(c[1], 3.0, 1e-14);
}

}  // namespace
}  // namespace ifog
