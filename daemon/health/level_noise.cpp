// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/level_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace ifog {
namespace {

constexpr std::size_t kWalk = LevelNoise::kStates - 1;
// Time constants of the processes, in blocks.
constexpr std::array<double, kWalk> kTimes{1.0, 10.0, 100.0, 1e3, 1e4};
// Ratios of the table, half a decade apart, and zero.
constexpr double kStepOfTable = 0.5;
constexpr double kLeastInstability = -3.5, kLeastWalk = -7.0;  // powers of ten
constexpr int kInstabilities = 9, kWalks = 17;
constexpr double kTwoErrors = 2.0;
// Loss of log-likelihood that corresponds to one standard error.
constexpr double kUnlikelier = 0.5;
// Limit of a mean in variances, after a few means: a step or slow turn is no noise and would hide later ones.
constexpr double kClip = 25.0, kFew = 30.0;
// The choice is repeated when the number of blocks has grown by 5 %.
constexpr double kChosenAgain = 1.05;

double sum(const LevelNoise::Vector& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

LevelNoise::LevelNoise() {
  filters_.reserve(static_cast<std::size_t>(kInstabilities * kWalks));
  for (int b = 0; b < kInstabilities; ++b)
    for (int k = 0; k < kWalks; ++k)
      filters_.push_back({b == 0 ? 0.0 : std::pow(10.0, kLeastInstability + kStepOfTable * (b - 1)),
                          k == 0 ? 0.0 : std::pow(10.0, kLeastWalk + kStepOfTable * (k - 1))});
}

// The walk starts diffuse: after one mean it is that mean, minus the other states and the noise.
void LevelNoise::Filter::begin(double mean) noexcept {
  state = {};
  state[kWalk] = mean;
  covariance = {};
  covariance[kWalk][kWalk] = 1.0;
  for (std::size_t i = 0; i < kWalk; ++i) {
    covariance[i][i] = instability;
    covariance[kWalk][i] = covariance[i][kWalk] = -instability;
    covariance[kWalk][kWalk] += instability;
  }
}

void LevelNoise::Filter::take(double mean, double blocks, const Vector& keep, double count) noexcept {
  for (std::size_t i = 0; i < kStates; ++i) {
    state[i] *= keep[i];
    for (std::size_t j = 0; j < kStates; ++j) covariance[i][j] *= keep[i] * keep[j];
    if (i != kWalk) covariance[i][i] += (1.0 - keep[i] * keep[i]) * instability;
  }
  covariance[kWalk][kWalk] += blocks * walk;
  innovation = mean - sum(state);
  Vector of_sum;  // covariance with the level
  for (std::size_t i = 0; i < kStates; ++i) of_sum[i] = sum(covariance[i]);
  total = sum(of_sum) + 1.0;
  for (std::size_t i = 0; i < kStates; ++i) {
    gain[i] = of_sum[i] / total;
    state[i] += gain[i] * innovation;
    for (std::size_t j = 0; j <= i; ++j) covariance[j][i] = covariance[i][j] -= gain[i] * of_sum[j];
  }
  const double square = innovation * innovation / total;
  squares += count > kFew ? std::min(square, kClip * squares / count) : square;
  logs += std::log(total);
}

double LevelNoise::level() const noexcept {
  return has_level_ ? sum(filters_[chosen_].state) : std::numeric_limits<double>::quiet_NaN();
}

// squares: of the filter in use, before this mean. The noise variance is increased by two standard errors, as
// allowed by the number of blocks.
void LevelNoise::innovate(double squares) noexcept {
  const double noise = count_ > 0.0 ? squares / count_ * (1.0 + kTwoErrors * std::sqrt(2.0 / count_)) : 0.0;
  if (!(noise > 0.0)) return;
  innovation_.known = true;
  innovation_.scale = std::sqrt(filters_[chosen_].total);
  innovation_.spread = innovation_.scale * std::sqrt(noise);
  innovation_.value = filters_[chosen_].innovation / innovation_.spread;
  innovation_.gain = filters_[chosen_].gain;
}

const LevelNoise::Innovation& LevelNoise::take(double mean, double blocks) noexcept {
  innovation_.known = false;
  if (!has_level_) {
    for (Filter& each : filters_) each.begin(mean);
    has_level_ = true;
    return innovation_;
  }
  innovation_.keep[kWalk] = 1.0;
  for (std::size_t i = 0; i < kWalk; ++i) innovation_.keep[i] = std::exp(-blocks / kTimes[i]);
  const double squares = filters_[chosen_].squares;
  for (Filter& each : filters_) each.take(mean, blocks, innovation_.keep, count_);
  innovate(squares);
  count_ += 1.0;
  if (count_ >= kChosenAgain * chosen_at_) choose();
  return innovation_;
}

// Chooses the fastest level that is still likely: a level assumed too slow would show false steps.
void LevelNoise::choose() noexcept {
  chosen_at_ = count_;
  std::vector<double> likelihood(filters_.size());
  for (std::size_t i = 0; i < filters_.size(); ++i)
    likelihood[i] = filters_[i].squares > 0.0
                        ? -0.5 * (count_ * std::log(filters_[i].squares / count_) + filters_[i].logs)
                        : -std::numeric_limits<double>::infinity();
  const double best = *std::max_element(likelihood.begin(), likelihood.end());
  double quickest = -1.0;
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    if (likelihood[i] < best - kUnlikelier) continue;
    const double follows = sum(filters_[i].gain);
    if (follows <= quickest) continue;
    quickest = follows;
    chosen_ = i;
  }
}

}  // namespace ifog
