// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/projection.h"

#include <gtest/gtest.h>

#include <random>

namespace ifog {
namespace {

// Normal equations: the second way to the same residual.
TEST(Projection, LeavesTheResidualOfLeastSquares) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd x(200, 3);
  Columns several(200, 2);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) x(i, j) = normal(random);
    for (Eigen::Index j = 0; j < 2; ++j) several(i, j) = normal(random) + x(i, j);
  }
  Eigen::VectorXd one = several.col(0);
  const Eigen::MatrixXd expected =
      several - x * (x.transpose() * x).ldlt().solve(x.transpose() * Eigen::MatrixXd(several));
  const Projection projection(x);
  projection.take_out_of(several);
  projection.take_out_of(one);
  EXPECT_LT((several - expected).norm(), 1e-10);
  EXPECT_LT((one - expected.col(0)).norm(), 1e-10);
  EXPECT_LT((x.transpose() * one).norm(), 1e-10);
}

TEST(Projection, TakesOutAMeanAndALine) {
  Eigen::MatrixXd x(5, 2);
  Eigen::VectorXd y(5);
  for (Eigen::Index i = 0; i < 5; ++i) {
    const double t = static_cast<double>(i) - 2.0;
    x.row(i) << 1.0, t;
    y[i] = 3.0 - 7.0 * t + (t * t - 2.0);  // t² - 2 is at right angles to 1 and t
  }
  Projection(x).take_out_of(y);
  EXPECT_LT((y - Eigen::VectorXd((Eigen::VectorXd(5) << 2, -1, -2, -1, 2).finished())).norm(), 1e-13);
}

TEST(Projection, WhatIsBesideAColumnIsOrthonormalAndWhole) {
  const Eigen::Vector4d column(1.0, -2.0, 0.0, 5.0);
  const Eigen::MatrixXd complement = Projection::complement(column);
  ASSERT_EQ(complement.cols(), 3);
  EXPECT_LT((complement.transpose() * complement - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((complement.transpose() * column).norm(), 1e-14);
}

}  // namespace
}  // namespace ifog
