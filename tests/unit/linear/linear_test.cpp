// SPDX-License-Identifier: Apache-2.0
// Least squares of our own and what is taken out of columns, against closed forms; an exact sum.
#include "filters/linear/exact_sum.h"
#include "filters/linear/normal_equations.h"
#include "filters/linear/projection.h"
#include "tests/unit/test.h"

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

// Normal equations: the second way to the same residual.
TEST(Projection, LeavesTheResidualOfLeastSquares) {
  test::Noise normal(1);
  Eigen::MatrixXd x(200, 3);
  Columns several(200, 2);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) x(i, j) = normal();
    for (Eigen::Index j = 0; j < 2; ++j) several(i, j) = normal() + x(i, j);
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

TEST(Projection, WhatIsBesideAColumnIsOrthonormalAndWhole) {
  const Eigen::Vector4d column(1.0, -2.0, 0.0, 5.0);
  const Eigen::MatrixXd complement = Projection::complement(column);
  ASSERT_EQ(complement.cols(), 3);
  EXPECT_LT((complement.transpose() * complement - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((complement.transpose() * column).norm(), 1e-14);
}

// A tenth of a day at 5 kHz, to a tenth of what a day may lose. The terms are whole multiples of 2^-70, so
// that 128-bit integers sum them exactly.
TEST(ExactSum, ATenthOfADayAt5kHzIsExactTo1e10) {
  ExactSum sum;
  __int128 exact = 0;
  std::uint64_t state = 88172645463325252ULL;
  constexpr long kSamples = 24L * 360 * 5000;
  for (long i = 0; i < kSamples; ++i) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    const auto units = static_cast<std::int64_t>(state >> 12);  // 52 bits, exact in a double: 0 … 3.8e-6 rad
    exact += units;
    sum.add(std::ldexp(static_cast<double>(units), -70));
  }
  const auto truth = static_cast<long double>(exact) * 0x1p-70L;
  EXPECT_LT(std::abs(static_cast<long double>(sum.value()) - truth), 1e-10L)
      << "of " << sum.value() << " rad";
}

}  // namespace
}  // namespace ifog
