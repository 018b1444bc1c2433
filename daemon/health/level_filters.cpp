// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/level_filters.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

constexpr std::size_t kWalkState = LevelFilters::kStates - 1;
// A product of totals may be so large before its logarithm is taken.
constexpr double kMuch = 1e100;

constexpr std::size_t pair(std::size_t row, std::size_t column) { return row * (row + 1) / 2 + column; }

}  // namespace

LevelFilters::LevelFilters(const std::vector<Ratios>& table)
    : size_(table.size()), lanes_((table.size() + kLanes - 1) / kLanes) {
  for (Lanes& at : lanes_) at.product.fill(1.0);
  for (std::size_t i = 0; i < size_; ++i) {
    lanes_[i / kLanes].instability[i % kLanes] = table[i].instability;
    lanes_[i / kLanes].walk[i % kLanes] = table[i].walk;
  }
}

// The walk's start is diffuse: after one mean it is that mean, less what the other states and the noise have.
void LevelFilters::begin(Lanes& at, double mean) noexcept {
  at.state = {};
  at.state[kWalkState].fill(mean);
  at.covariance = {};
  at.covariance[pair(kWalkState, kWalkState)].fill(1.0);
  for (std::size_t i = 0; i < kWalkState; ++i)
    for (std::size_t f = 0; f < kLanes; ++f) {
      at.covariance[pair(i, i)][f] = at.instability[f];
      at.covariance[pair(kWalkState, i)][f] = -at.instability[f];
      at.covariance[pair(kWalkState, kWalkState)][f] += at.instability[f];
    }
}

void LevelFilters::begin(double mean) noexcept {
  for (Lanes& at : lanes_) begin(at, mean);
}

void LevelFilters::predict(Lanes& at, const Vector& keep, double blocks) noexcept {
  for (std::size_t i = 0; i < kStates; ++i) {
    for (std::size_t f = 0; f < kLanes; ++f) at.state[i][f] *= keep[i];
    for (std::size_t j = 0; j <= i; ++j) {
      const double both = keep[i] * keep[j];
      Lane& covariance = at.covariance[pair(i, j)];
      for (std::size_t f = 0; f < kLanes; ++f) covariance[f] *= both;
    }
    if (i == kWalkState) continue;
    const double fresh = 1.0 - keep[i] * keep[i];
    Lane& variance = at.covariance[pair(i, i)];
    for (std::size_t f = 0; f < kLanes; ++f) variance[f] += fresh * at.instability[f];
  }
  Lane& variance = at.covariance[pair(kWalkState, kWalkState)];
  for (std::size_t f = 0; f < kLanes; ++f) variance[f] += blocks * at.walk[f];
}

void LevelFilters::update(Lanes& at, double mean) noexcept {
  Lane level{}, total{}, inverse{};
  std::array<Lane, kStates> of_sum{};
  for (std::size_t i = 0; i < kStates; ++i) {
    for (std::size_t f = 0; f < kLanes; ++f) level[f] += at.state[i][f];
    for (std::size_t j = 0; j < kStates; ++j) {
      const Lane& covariance = at.covariance[i >= j ? pair(i, j) : pair(j, i)];
      for (std::size_t f = 0; f < kLanes; ++f) of_sum[i][f] += covariance[f];
    }
    for (std::size_t f = 0; f < kLanes; ++f) total[f] += of_sum[i][f];
  }
  for (std::size_t f = 0; f < kLanes; ++f) {
    total[f] += 1.0;
    inverse[f] = 1.0 / total[f];
    at.innovation[f] = mean - level[f];
  }
  for (std::size_t i = 0; i < kStates; ++i) {
    Lane gain{};
    for (std::size_t f = 0; f < kLanes; ++f) {
      gain[f] = of_sum[i][f] * inverse[f];
      at.state[i][f] += gain[f] * at.innovation[f];
    }
    for (std::size_t j = 0; j <= i; ++j)
      for (std::size_t f = 0; f < kLanes; ++f) at.covariance[pair(i, j)][f] -= gain[f] * of_sum[j][f];
  }
  at.total = total;
  at.of_sum = of_sum;
}

void LevelFilters::judge(Lanes& at, double count, double most_squares) noexcept {
  double most = 0.0;
  for (std::size_t f = 0; f < kLanes; ++f) {
    const double square = at.innovation[f] * at.innovation[f] / at.total[f];
    // Written so that no count at all means no limit.
    at.squares[f] += square * count > most_squares * at.squares[f] && count > 0.0
                         ? most_squares * at.squares[f] / count
                         : square;
    at.product[f] *= at.total[f];
    most = std::max(most, at.product[f]);
  }
  if (most < kMuch) return;
  for (std::size_t f = 0; f < kLanes; ++f) {
    at.logs[f] += std::log(at.product[f]);
    at.product[f] = 1.0;
  }
}

void LevelFilters::take(double mean, double blocks, const Vector& keep, double count,
                        double most_squares) noexcept {
  for (Lanes& at : lanes_) {
    predict(at, keep, blocks);
    update(at, mean);
    judge(at, count, most_squares);
  }
}

LevelFilters::Ratios LevelFilters::ratios(std::size_t i) const noexcept {
  return {lane(i).instability[i % kLanes], lane(i).walk[i % kLanes]};
}

LevelFilters::Vector LevelFilters::gain(std::size_t i) const noexcept {
  Vector out{};
  for (std::size_t s = 0; s < kStates; ++s) out[s] = lane(i).of_sum[s][i % kLanes] / total(i);
  return out;
}

double LevelFilters::level(std::size_t i) const noexcept {
  double out = 0.0;
  for (const Lane& state : lane(i).state) out += state[i % kLanes];
  return out;
}

double LevelFilters::log_variance(std::size_t i) const noexcept {
  return lane(i).logs[i % kLanes] + std::log(lane(i).product[i % kLanes]);
}

}  // namespace ifog
