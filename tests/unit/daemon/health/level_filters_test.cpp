// SPDX-License-Identifier: Apache-2.0
// Filters in lanes compared with a Kalman filter as the books write it, with matrices, one after the other.
#include "daemon/health/level_filters.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace ifog {
namespace {

constexpr auto kStates = static_cast<Eigen::Index>(LevelFilters::kStates);

struct Plain {
  LevelFilters::Ratios ratios;
  Eigen::VectorXd state = Eigen::VectorXd::Zero(kStates), gain = Eigen::VectorXd::Zero(kStates);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(kStates, kStates);
  double innovation = 0.0, total = 0.0, squares = 0.0, log_variance = 0.0;

  // Of a walk that began anywhere, after one mean.
  void begin(double mean) {
    constexpr double kAnywhere = 1e7;
    state.setZero();
    covariance.setZero();
    covariance.diagonal().setConstant(ratios.instability);
    covariance(kStates - 1, kStates - 1) = kAnywhere;
    const double before = squares, logs = log_variance;
    update(mean);
    squares = before, log_variance = logs;
  }
  void predict(const Eigen::VectorXd& keep, double blocks) {
    state = keep.cwiseProduct(state);
    covariance = keep.asDiagonal() * covariance * keep.asDiagonal();
    for (Eigen::Index i = 0; i + 1 < kStates; ++i)
      covariance(i, i) += ratios.instability * (1.0 - keep[i] * keep[i]);
    covariance(kStates - 1, kStates - 1) += ratios.walk * blocks;
  }
  void update(double mean) {
    const Eigen::VectorXd of_sum = covariance.rowwise().sum();
    total = of_sum.sum() + 1.0;
    innovation = mean - state.sum();
    gain = of_sum / total;
    state += gain * innovation;
    covariance -= gain * of_sum.transpose();
    squares += innovation * innovation / total;
    log_variance += std::log(total);
  }
};

void expect_like(const LevelFilters& filters, std::size_t f, const Plain& plain) {
  EXPECT_NEAR(filters.innovation(f), plain.innovation, 1e-5);
  EXPECT_NEAR(filters.total(f), plain.total, 1e-5 * plain.total);
  EXPECT_NEAR(filters.level(f), plain.state.sum(), 1e-5);
  EXPECT_NEAR(filters.squares(f), plain.squares, 1e-5 * plain.squares);
  EXPECT_NEAR(filters.log_variance(f), plain.log_variance, 1e-5 * plain.log_variance + 1e-9);
  for (Eigen::Index s = 0; s < kStates; ++s)
    EXPECT_NEAR(filters.gain(f)[static_cast<std::size_t>(s)], plain.gain[s], 1e-5);
}

TEST(LevelFilters, AreKalmanFiltersEach) {
  std::vector<LevelFilters::Ratios> table;
  for (const double instability : {0.0, 1e-3, 0.3})
    for (const double walk : {0.0, 1e-6, 0.1, 3.0}) table.push_back({instability, walk});
  LevelFilters filters(table);
  ASSERT_EQ(filters.size(), table.size());
  std::vector<Plain> plain;
  for (const LevelFilters::Ratios& ratios : table) plain.push_back({ratios});
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  filters.begin(2.0);
  for (Plain& each : plain) each.begin(2.0);
  double count = 0.0;
  for (int i = 0; i < 1500; ++i) {
    const double blocks = i % 7 == 3 ? 5.0 : 1.0;
    Eigen::VectorXd keep = Eigen::VectorXd::Ones(kStates);
    LevelFilters::Vector kept{};
    kept.back() = 1.0;
    for (Eigen::Index s = 0; s + 1 < kStates; ++s)
      kept[static_cast<std::size_t>(s)] = keep[s] = std::exp(-blocks / std::pow(10.0, s));
    const double mean = 2.0 + normal(random);
    filters.take(mean, blocks, kept, count, 1e9);
    for (Plain& each : plain) each.predict(keep, blocks), each.update(mean);
    count += 1.0;
    if (i == 800) {
      filters.begin(2.5);
      for (Plain& each : plain) each.begin(2.5);
    }
  }
  for (std::size_t f = 0; f < table.size(); ++f) expect_like(filters, f, plain[f]);
}

TEST(LevelFilters, AMeanCountsForSoManyMeanSquaresAtMost) {
  LevelFilters filters({{0.0, 0.0}});
  LevelFilters::Vector keep{};
  keep.back() = 1.0;
  filters.begin(0.0);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) filters.take(normal(random), 1.0, keep, i > 30 ? i : 0.0, 25.0);
  const double before = filters.squares(0);
  filters.take(1000.0, 1.0, keep, 100.0, 25.0);
  EXPECT_NEAR(filters.squares(0), before * (1.0 + 25.0 / 100.0), 1e-9 * before);
}

}  // namespace
}  // namespace ifog
