// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/level_filter.h"

#include <numeric>

namespace ifog {
namespace {

constexpr std::size_t kWalkState = LevelFilter::kStates - 1;

}  // namespace

// The walk starts diffuse: after one mean it is that mean, minus the other states and the noise.
void LevelFilter::begin(double mean) noexcept {
  state_ = {};
  state_[kWalkState] = mean;
  covariance_ = {};
  covariance_[kWalkState][kWalkState] = 1.0;
  for (std::size_t i = 0; i < kWalkState; ++i) {
    covariance_[i][i] = ratios_.instability;
    covariance_[kWalkState][i] = covariance_[i][kWalkState] = -ratios_.instability;
    covariance_[kWalkState][kWalkState] += ratios_.instability;
  }
}

void LevelFilter::predict(const Vector& keep, double blocks) noexcept {
  for (std::size_t i = 0; i < kStates; ++i) {
    state_[i] *= keep[i];
    for (std::size_t j = 0; j < kStates; ++j) covariance_[i][j] *= keep[i] * keep[j];
    if (i != kWalkState) covariance_[i][i] += (1.0 - keep[i] * keep[i]) * ratios_.instability;
  }
  covariance_[kWalkState][kWalkState] += blocks * ratios_.walk;
}

void LevelFilter::update(double mean) noexcept {
  innovation_ = mean - level();
  for (std::size_t i = 0; i < kStates; ++i)
    of_sum_[i] = std::accumulate(covariance_[i].begin(), covariance_[i].end(), 0.0);
  total_ = std::accumulate(of_sum_.begin(), of_sum_.end(), 0.0) + 1.0;
  const Vector gains = gain();
  for (std::size_t i = 0; i < kStates; ++i) {
    state_[i] += gains[i] * innovation_;
    for (std::size_t j = 0; j <= i; ++j) covariance_[j][i] = covariance_[i][j] -= gains[i] * of_sum_[j];
  }
}

void LevelFilter::take(double mean, double blocks, const Vector& keep, double count,
                       double most_squares) noexcept {
  predict(keep, blocks);
  update(mean);
  const double square = innovation_ * innovation_ / total_;
  // Without a count there is no limit.
  const bool beyond = square * count > most_squares * squares_ && count > 0.0;
  squares_ += beyond ? most_squares * squares_ / count : square;
  logs_ += std::log(total_);
}

LevelFilter::Vector LevelFilter::gain() const noexcept {
  Vector out{};
  for (std::size_t i = 0; i < kStates; ++i) out[i] = of_sum_[i] / total_;
  return out;
}

double LevelFilter::level() const noexcept { return std::accumulate(state_.begin(), state_.end(), 0.0); }

}  // namespace ifog
