// SPDX-License-Identifier: Apache-2.0
// The likelihood of a walk, one Kalman filter a trial, against the Gaussian density of the same means written
// out.
#include "filters/estimator/walk_likelihood.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace {

constexpr int kBlock = 64;

// Differences of neighbouring means of white noise of variance one and of a walk of `walk` a mean have the
// covariance walk I + tridiagonal(-1, 2, -1). -2 log-likelihood, the scale left open.
double misfit(const std::vector<double>& means, double walk) {
  const auto n = static_cast<Eigen::Index>(means.size()) - 1;
  Eigen::MatrixXd covariance = (walk + 2.0) * Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd differences(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i > 0) covariance(i, i - 1) = covariance(i - 1, i) = -1.0;
    differences(i) = means[static_cast<std::size_t>(i) + 1] - means[static_cast<std::size_t>(i)];
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  double logs = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) logs += 2.0 * std::log(factor.matrixL()(i, i));
  return static_cast<double>(n) * std::log(differences.dot(factor.solve(differences))) + logs;
}

TEST(WalkLikelihood, IsTheDensityOfTheMeans) {
  constexpr double kNearly = 1.0;
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    ifog::WalkLikelihood likelihood;
    std::vector<double> means;
    double level = 0.0, sum = 0.0;
    for (int i = 0; i < 200 * kBlock; ++i) {
      level += 1e-3 * normal(random);
      const double rate = level + normal(random);
      likelihood.take(0, rate);
      sum += rate;
      if (i % kBlock != kBlock - 1) continue;
      means.push_back(sum / kBlock);
      sum = 0.0;
    }
    // The last mean is worked in while the next one is read.
    for (int i = 0; i < kBlock - 1; ++i) likelihood.take(0, 0.0);
    likelihood.set_aside();
    EXPECT_EQ(likelihood.quickest(kNearly), std::numeric_limits<double>::infinity()) << "not yet believed";
    likelihood.believe();
    double best = 1e300, found = 0.0;
    for (double ratio = 1e-12; ratio < 1e-4; ratio *= 1.5) {
      const double here = misfit(means, ratio * kBlock * kBlock);
      best = std::min(best, here);
      if (here <= best + kNearly) found = ratio;
    }
    EXPECT_NEAR(likelihood.quickest(kNearly) / found, 1.0, 1e-9) << seed;
  }
}

// Of two stretches with a jump between them that was broken off the jump is none of a walk's.
TEST(WalkLikelihood, GoesOnFromNothingAfterABreak) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  ifog::WalkLikelihood likelihood;
  for (const double level : {0.0, 100.0}) {
    for (int i = 0; i < 200 * kBlock; ++i) likelihood.take(0, level + normal(random));
    likelihood.break_off(0);
  }
  likelihood.set_aside();
  likelihood.believe();
  // A quiet record of n samples hides walks of some 10 / n^2.
  EXPECT_LT(likelihood.quickest(1.0), 100.0 / std::pow(200.0 * kBlock, 2));
  likelihood.forget();
  EXPECT_EQ(likelihood.quickest(1.0), std::numeric_limits<double>::infinity());
}

}  // namespace
