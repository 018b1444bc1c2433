// SPDX-License-Identifier: Apache-2.0
// The smoother against the least squares it stands for, and over steps and gaps.
#include "filters/estimator/smoother.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/unit/estimator/drive.h"

namespace {

using namespace ifog::test;

// The smoothed walk is the least-squares solution of measurements and steps: solved densely.
TEST(Smoother, IsTheLeastSquaresSolution) {
  constexpr int kLength = 60;
  constexpr double kNoise = 0.7;
  Record r = record(31, kLength, 0.1);
  r.measured[20] = r.measured[21] = std::nan("");
  std::vector<double> walk(kLength);
  for (std::size_t i = 0; i < walk.size(); ++i)
    walk[i] = i == 40 ? 25.0 : 0.05 + 0.001 * static_cast<double>(i);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(kLength, kLength);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kLength);
  for (int i = 0; i < kLength; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (std::isfinite(r.measured[k])) {
      normal(i, i) += 1.0 / kNoise;
      right(i) += r.measured[k] / kNoise;
    }
    if (i == 0) continue;
    normal(i, i) += 1.0 / walk[k];
    normal(i - 1, i - 1) += 1.0 / walk[k];
    normal(i, i - 1) -= 1.0 / walk[k];
    normal(i - 1, i) -= 1.0 / walk[k];
  }
  const Eigen::MatrixXd covariance = normal.inverse();
  const Eigen::VectorXd solution = covariance * right;
  const ifog::Smoothed got = ifog::smooth_walk(r.measured, walk, kNoise);
  double owed = 0.0;
  for (int i = 0; i < kLength; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(got.rate_radps[k], solution(i), 1e-10) << i;
    EXPECT_NEAR(got.variance_rad2ps2[k], covariance(i, i), 1e-10) << i;
    if (std::isfinite(r.measured[k])) owed += r.measured[k] - got.rate_radps[k];
  }
  EXPECT_NEAR(owed, 0.0, 1e-9);
}

TEST(Smoother, BeatsTheFilterAtRestAndInMotionAndKeepsTheAngle) {
  constexpr int kLength = 60'000;
  for (const double ratio : {1e-3, 1e-6}) {
    for (const bool moving : {false, true}) {
      double smoothed = 0.0, filtered = 0.0;
      for (std::uint64_t seed = 32; seed < 38; ++seed) {
        const Record r = record(seed, kLength, ratio, [moving](int i) {
          return !moving ? 0.0 : i > 30'000 && i < 40'000 ? 20.0 : i > 50'000 ? 2e-2 * (i - 50'000) : 0.0;
        });
        const std::vector<double> dt(kLength, kPeriod);
        const std::vector<std::vector<double>> rates{r.measured};
        const ifog::Smoothed got = ifog::smooth(told(ratio), rates, dt, kPeriod)[0];
        smoothed += mean_square_error(got.rate_radps, r.truth, 1000);
        filtered += mean_square_error(run(told(ratio), r.measured).denoised, r.truth, 1000);
        double owed = 0.0;
        for (std::size_t i = 0; i < r.measured.size(); ++i) owed += r.measured[i] - got.rate_radps[i];
        EXPECT_NEAR(owed, 0.0, 1e-5) << ratio << (moving ? " moving" : " at rest");
      }
      EXPECT_LT(smoothed, 0.7 * filtered) << ratio << (moving ? " moving" : " at rest");
    }
  }
}

}  // namespace
