// SPDX-License-Identifier: Apache-2.0
// Jumps that dwarf the noise: what is smoothed behind one is what its own measurements say, with the variance
// that they have, however far it was from what came before.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <vector>

#include "filters/smoother/motion_smoother.h"
#include "tests/unit/estimator/drive.h"

namespace {

using namespace ifog::test;

constexpr int kLength = 60, kJump = 30;
constexpr double kWalk = 0.01;
constexpr float kMemory = 5.0F;

struct Solution {
  Eigen::VectorXd rate, variance;
};

// Level, slope and curvature of each measurement, solved densely; of what was before nothing is known.
Solution least_squares(const Eigen::VectorXd& noise) {
  const Eigen::Index length = noise.size();
  Eigen::Matrix3d from, driving;
  from << 1.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0;
  driving << 1.0 / 20, 1.0 / 8, 1.0 / 6, 1.0 / 8, 1.0 / 3, 1.0 / 2, 1.0 / 6, 1.0 / 2, 1.0;
  driving *= std::pow(1.5 / kMemory, 6);
  driving(0, 0) += kWalk;
  Eigen::Matrix<double, 3, 6> step;
  step << -from, Eigen::Matrix3d::Identity();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 * length, 3 * length);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(3 * length);
  for (Eigen::Index i = 0; i < length; ++i) {
    normal(3 * i, 3 * i) += 1.0;
    right(3 * i) += noise(i);
    if (i > 0) normal.block<6, 6>(3 * i - 3, 3 * i - 3) += step.transpose() * driving.inverse() * step;
  }
  const Eigen::MatrixXd covariance = normal.inverse();
  const Eigen::VectorXd solution = covariance * right;
  Solution out{Eigen::VectorXd(length), Eigen::VectorXd(length)};
  for (Eigen::Index i = 0; i < length; ++i) {
    out.rate(i) = solution(3 * i);
    out.variance(i) = covariance(3 * i, 3 * i);
  }
  return out;
}

// A slope that lasts goes through such least squares as it is.
double motion(int i, double height) {
  return i < kJump ? 0.0 : i == kJump ? height : height * (-1.0 + 0.01 * (i - kJump));
}

TEST(SmoothedJumps, LeaveWhatIsBehindThemToItsOwnMeasurements) {
  const Record r = record(71, kLength, 0.1);
  const std::vector<double> walk(kLength, kWalk);
  std::vector<float> memories(kLength, kMemory);
  memories[kJump] = ifog::pace::kBroken;
  Eigen::VectorXd behind(kLength - kJump - 1);
  for (int i = kJump + 1; i < kLength; ++i) behind(i - kJump - 1) = r.measured[static_cast<std::size_t>(i)];
  const Solution expected = least_squares(behind);
  for (const double height : {1e3, 1e4, 1e5, 1e6, 1e7, 1e8}) {
    std::vector<double> rate = r.measured;
    for (int i = 0; i < kLength; ++i) rate[static_cast<std::size_t>(i)] += motion(i, height);
    const ifog::Smoothed got = ifog::smooth_course({rate, walk, {}, memories}, 1.0);
    for (int i = kJump + 1; i < kLength; ++i) {
      const auto k = static_cast<std::size_t>(i);
      EXPECT_NEAR(got.rate_radps[k] - motion(i, height), expected.rate(i - kJump - 1), 1e-3)
          << height << " " << i;
      EXPECT_NEAR(got.variance_rad2ps2[k], expected.variance(i - kJump - 1), 1e-3) << height << " " << i;
    }
  }
}

}  // namespace
