// SPDX-License-Identifier: Apache-2.0
// The smoother against the least squares that it stands for, solved densely.
#include <Eigen/Dense>

#include "filters/smoother/motion_smoother.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;

constexpr int kLength = 60;

struct DenseSolution {
  Eigen::VectorXd rate, variance;
};

constexpr double kSlopeBefore =
    100.0;  // variance of slope and curvature where a motion begins, over that of the noise

// Level, slope and curvature of each sample are unknown. At rest there is a level that walks; in a motion white noise
// drives the curvature's derivative, by the memory of the sample. A record that begins in a motion says nothing of what
// was before.
DenseSolution least_squares(const ifog::RateCourse& course, double noise) {
  const auto length = static_cast<Eigen::Index>(course.rate.size());
  const auto memory_of = [&](Eigen::Index i) -> double {
    return course.memories.empty() ? ifog::pace::kRest : course.memories[static_cast<std::size_t>(i)];
  };
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 * length, 3 * length);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(3 * length);
  for (Eigen::Index i = 0; i < length; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double memory = memory_of(i), memory_before = i > 0 ? memory_of(i - 1) : 0.0;
    const bool moves = memory > 0.0, moved = memory_before > 0.0;
    if (!moves) normal.block<2, 2>(3 * i + 1, 3 * i + 1) += Eigen::Matrix2d::Identity();
    if (std::isfinite(course.rate[k])) {
      normal(3 * i, 3 * i) += 1.0 / noise;
      right(3 * i) += course.rate[k] / noise;
    }
    if (i == 0) continue;
    const double t = course.steps.empty() ? 1.0 : course.steps[k];
    Eigen::Matrix3d from = Eigen::Vector3d::UnitX() * Eigen::RowVector3d::UnitX();
    if (moved) from << 1.0, t, 0.5 * t * t, 0.0, 1.0, t, 0.0, 0.0, 1.0;
    Eigen::Matrix3d driving = Eigen::Matrix3d::Zero();
    if (moves || moved) {
      const double shorter = !moves ? memory_before : !moved ? memory : std::min(memory, memory_before);
      driving << std::pow(t, 5) / 20, std::pow(t, 4) / 8, std::pow(t, 3) / 6, std::pow(t, 4) / 8,
          std::pow(t, 3) / 3, t * t / 2, std::pow(t, 3) / 6, t * t / 2, t;
      driving *= noise * std::pow(1.5 / shorter, 6);
    }
    driving(0, 0) += course.walk[k];
    if (moves && !moved) driving(1, 1) += kSlopeBefore * noise, driving(2, 2) += kSlopeBefore * noise;
    // A sample at rest has a level and nothing else.
    const int n = moves ? 3 : 1;
    const Eigen::MatrixXd weight = driving.topLeftCorner(n, n).inverse();
    Eigen::MatrixXd step(n, 6);
    step << -from.topRows(n), Eigen::MatrixXd::Identity(n, 3);
    normal.block<6, 6>(3 * i - 3, 3 * i - 3) += step.transpose() * weight * step;
  }
  const Eigen::MatrixXd covariance = normal.inverse();
  const Eigen::VectorXd solution = covariance * right;
  DenseSolution out{Eigen::VectorXd(length), Eigen::VectorXd(length)};
  for (Eigen::Index i = 0; i < length; ++i) {
    out.rate(i) = solution(3 * i);
    out.variance(i) = covariance(3 * i, 3 * i);
  }
  return out;
}

// Against the dense solution; and what was measured and what is smoothed have the same sum.
void expect_least_squares(const ifog::RateCourse& course, double noise, double tolerance) {
  const DenseSolution expected = least_squares(course, noise);
  const ifog::Smoothed got = ifog::smooth_course(course, noise);
  double owed = 0.0;
  for (std::size_t i = 0; i < course.rate.size(); ++i) {
    EXPECT_NEAR(got.rate_radps[i], expected.rate(static_cast<Eigen::Index>(i)), tolerance) << i;
    EXPECT_NEAR(got.variance_rad2ps2[i], expected.variance(static_cast<Eigen::Index>(i)), tolerance) << i;
    if (std::isfinite(course.rate[i])) owed += course.rate[i] - got.rate_radps[i];
  }
  EXPECT_NEAR(owed, 0.0, 1e-9);
}

TEST(Smoother, IsTheLeastSquaresSolution) {
  Record r = record(31, kLength, 0.1);
  r.measured[20] = r.measured[21] = std::nan("");
  std::vector<double> walk(kLength);
  for (std::size_t i = 0; i < walk.size(); ++i)
    walk[i] = i == 40 ? 25.0 : 0.05 + 0.001 * static_cast<double>(i);
  expect_least_squares({r.measured, walk, {}, {}}, 0.7, 1e-10);
}

// Rest, a motion whose memory changes and that is not sampled evenly, and rest again.
TEST(Smoother, IsTheLeastSquaresSolutionInMotion) {
  Record r = record(33, kLength, 0.1, [](int i) { return i > 20 && i < 45 ? 0.3 * (i - 20) : 0.0; });
  r.measured[30] = r.measured[31] = std::nan("");
  std::vector<double> walk(kLength, 0.01), steps(kLength, 1.0);
  std::vector<float> memories(kLength, ifog::pace::kRest);
  for (std::size_t i = 15; i < 50; ++i) memories[i] = 2.0F + 0.1F * static_cast<float>(std::min(i, 65 - i));
  steps[25] = 2.0;
  steps[35] = 0.5;
  expect_least_squares({r.measured, walk, steps, memories}, 0.7, 1e-8);
}

constexpr int kJump = 30;
constexpr double kWalk = 0.01;
constexpr float kMemory = 5.0F;

// A slope that lasts goes through such least squares as it is.
double motion(int i, double height) {
  return i < kJump ? 0.0 : i == kJump ? height : height * (-1.0 + 0.01 * (i - kJump));
}

// Jumps that dwarf the noise: what is smoothed behind one is what its own measurements say, with the variance
// that they have, however far it was from what came before.
TEST(Smoother, LeavesWhatIsBehindAJumpToItsOwnMeasurements) {
  const Record r = record(71, kLength, 0.1);
  const std::vector<double> walk(kLength, kWalk);
  std::vector<float> memories(kLength, kMemory);
  memories[kJump] = ifog::pace::kBroken;
  const std::vector<float> even(kLength - kJump - 1, kMemory);
  const DenseSolution expected =
      least_squares({std::span(r.measured).subspan(kJump + 1), walk, {}, even}, 1.0);
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
