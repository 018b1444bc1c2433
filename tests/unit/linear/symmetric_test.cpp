// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/symmetric.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ifog {
namespace {

// (2 1; 1 2): eigenvalues 1 and 3 along (1, -1) and (1, 1), inverse (2 -1; -1 2) / 3, determinant 3.
Eigen::MatrixXd two() { return (Eigen::MatrixXd(2, 2) << 2, 1, 1, 2).finished(); }

TEST(Symmetric, EigenvaluesAscend) {
  EXPECT_LT((symmetric_eigenvalues(two()) - Eigen::Vector2d(1, 3)).norm(), 1e-15);
  const SymmetricEigen eigen = symmetric_eigen(two());
  EXPECT_LT((eigen.values - Eigen::Vector2d(1, 3)).norm(), 1e-15);
  EXPECT_NEAR(std::abs(eigen.vectors(0, 1)), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(eigen.vectors(0, 0), -eigen.vectors(1, 0), 1e-15);
}

TEST(Symmetric, SolvesAndInverts) {
  const SymmetricSolver solver(two());
  EXPECT_TRUE(solver.is_positive());
  EXPECT_LT((solver.solve(Eigen::Vector2d(3, 0)) - Eigen::Vector2d(2, -1)).norm(), 1e-15);
  EXPECT_LT((3.0 * solver.inverse() - (Eigen::MatrixXd(2, 2) << 2, -1, -1, 2).finished()).norm(), 1e-15);
  EXPECT_NEAR(solver.pivots().prod(), 3.0, 1e-15);
}

TEST(Symmetric, TellsWhatIsNotPositive) {
  const Eigen::MatrixXd saddle = (Eigen::MatrixXd(2, 2) << 1, 2, 2, 1).finished();
  EXPECT_FALSE(SymmetricSolver(saddle).is_positive());
  EXPECT_FALSE(CholeskyFactor(saddle).exists());
}

TEST(Symmetric, CholeskyFactorSolves) {
  const CholeskyFactor factor(two());
  ASSERT_TRUE(factor.exists());
  EXPECT_NEAR(factor.log_determinant(), 0.5 * std::log(3.0), 1e-15);
  EXPECT_LT((factor.solve(Eigen::VectorXd(Eigen::Vector2d(3, 0))) - Eigen::Vector2d(2, -1)).norm(), 1e-15);
  EXPECT_LT((factor.solve(two()) - Eigen::MatrixXd::Identity(2, 2)).norm(), 1e-15);
}

}  // namespace
}  // namespace ifog
