// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/notice/step_bound.h"

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <numeric>

namespace ifog::bench {
namespace {

constexpr double kPast_s = 3.0 * 86400.0;
// Variance of the unknown initial bias, in units of the white noise of a block.
constexpr double kAnyBias = 1e8;

double normal(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

}  // namespace

std::vector<double> left_of_step(const NoiseKind& kind, double step, double block_s, std::size_t blocks) {
  std::mt19937_64 unused(1);
  const SlowNoise noise(kind, block_s, unused);
  const auto n = static_cast<Eigen::Index>(noise.processes().size() + 1);
  const double white = kind.N * kind.N / block_s;
  Eigen::VectorXd keep = Eigen::VectorXd::Ones(n), drive = Eigen::VectorXd::Zero(n),
                  state = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const SlowNoise::Markov& process = noise.processes()[static_cast<std::size_t>(i)];
    keep[i] = process.keep;
    drive[i] = process.drive * process.drive;
    covariance(i, i) = drive[i] / (1.0 - keep[i] * keep[i]);
  }
  drive[n - 1] = kind.K * kind.K * block_s;
  covariance(n - 1, n - 1) = kAnyBias * white;
  const double past = kPast_s / block_s, all = past + static_cast<double>(blocks);
  std::vector<double> out;
  for (double block = 0.0; block < all; block += 1.0) {
    const Eigen::VectorXd of_sum = covariance.rowwise().sum();
    const double total = of_sum.sum() + white;
    // The step alone passes through the filter; before it the input is zero.
    const double left = block < past ? 0.0 : step - state.sum();
    if (block >= past) out.push_back(left / std::sqrt(total));
    state = keep.cwiseProduct(state + of_sum * (left / total));
    covariance -= of_sum * of_sum.transpose() / total;
    covariance = keep.asDiagonal() * covariance * keep.asDiagonal();
    covariance.diagonal() += drive;
  }
  return out;
}

double deviations(const std::vector<double>& left) {
  return std::sqrt(std::inner_product(left.begin(), left.end(), left.begin(), 0.0));
}

double best_share(double deviations, double look_s, double alarm_every_s) {
  double low = 0.0, high = 10.0;
  for (int halvings = 0; halvings < 60; ++halvings) {
    const double middle = 0.5 * (low + high);
    (1.0 - normal(middle) > look_s / alarm_every_s ? low : high) = middle;
  }
  return normal(deviations - high);
}

}  // namespace ifog::bench
