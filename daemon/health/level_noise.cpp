// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/level_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace ifog {
namespace {

constexpr std::size_t kWalk = LevelNoise::kStates - 1;
// Time constants of the processes, in blocks.
constexpr std::array<double, kWalk> kTimes{1.0, 10.0, 100.0, 1e3, 1e4};
// Ratios of the table, half a decade apart, and none.
constexpr double kStepOfTable = 0.5;
constexpr double kLeastInstability = -3.5, kLeastWalk = -7.0;  // powers of ten
constexpr int kInstabilities = 9, kWalks = 17;
constexpr double kTwoErrors = 2.0;
// As many units of log likelihood below the best as one standard error is.
constexpr double kUnlikelier = 0.5;
// A mean counts for this many variances at most, once there are a few: a step or a slow turn is no noise, and
// would hide the next ones for as long as the watch has run.
constexpr double kClip = 25.0, kFew = 30.0;

double sum(const LevelNoise::Vector& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

LevelNoise::LevelNoise() {
  for (int b = 0; b < kInstabilities; ++b)
    for (int k = 0; k < kWalks; ++k) {
      Filter filter;
      if (b > 0) filter.instability = std::pow(10.0, kLeastInstability + kStepOfTable * (b - 1));
      if (k > 0) filter.walk = std::pow(10.0, kLeastWalk + kStepOfTable * (k - 1));
      filters_.push_back(filter);
    }
}

double LevelNoise::Filter::level() const noexcept { return sum(state); }

// The walk's start is diffuse: after one mean it is that mean, less what the other states and the noise have.
void LevelNoise::Filter::begin(double mean) noexcept {
  state = {};
  state[kWalk] = mean;
  covariance = {};
  double others = 0.0;
  for (std::size_t i = 0; i < kWalk; ++i) {
    covariance[i][i] = instability;
    covariance[i][kWalk] = covariance[kWalk][i] = -instability;
    others += instability;
  }
  covariance[kWalk][kWalk] = others + 1.0;
}

void LevelNoise::Filter::predict(const Vector& keep, double blocks) noexcept {
  for (std::size_t i = 0; i < kStates; ++i) {
    state[i] *= keep[i];
    for (std::size_t j = 0; j < kStates; ++j) covariance[i][j] *= keep[i] * keep[j];
  }
  for (std::size_t i = 0; i < kWalk; ++i) covariance[i][i] += instability * (1.0 - keep[i] * keep[i]);
  covariance[kWalk][kWalk] += walk * blocks;
}

// Returns the innovation.
double LevelNoise::Filter::update(double mean, double most_square) noexcept {
  Vector of_sum{};
  for (std::size_t i = 0; i < kStates; ++i)
    for (std::size_t j = 0; j < kStates; ++j) of_sum[j] += covariance[i][j];
  total = sum(of_sum) + 1.0;
  const double innovation = mean - level();
  for (std::size_t i = 0; i < kStates; ++i) gain[i] = of_sum[i] / total;
  for (std::size_t i = 0; i < kStates; ++i) {
    state[i] += gain[i] * innovation;
    for (std::size_t j = 0; j < kStates; ++j) covariance[i][j] -= gain[i] * of_sum[j];
  }
  squares += std::min(innovation * innovation / total, most_square);
  log_variance += std::log(total);
  return innovation;
}

double LevelNoise::level() const noexcept {
  return has_level_ ? filters_[chosen_].level() : std::numeric_limits<double>::quiet_NaN();
}

const LevelNoise::Innovation& LevelNoise::take(double mean, double blocks) noexcept {
  innovation_.known = false;
  if (!has_level_) {
    for (Filter& filter : filters_) filter.begin(mean);
    has_level_ = true;
    return innovation_;
  }
  innovation_.keep[kWalk] = 1.0;
  for (std::size_t i = 0; i < kWalk; ++i) innovation_.keep[i] = std::exp(-blocks / kTimes[i]);
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    Filter& filter = filters_[i];
    // The noise is not known better than the blocks so far allow: its variance as large as two standard
    // errors make it.
    const double noise = i == chosen_ && count_ > 0.0
                             ? filter.squares / count_ * (1.0 + kTwoErrors * std::sqrt(2.0 / count_))
                             : 0.0;
    filter.predict(innovation_.keep, blocks);
    const double innovation = filter.update(
        mean, count_ > kFew ? kClip * filter.squares / count_ : std::numeric_limits<double>::infinity());
    if (!(noise > 0.0)) continue;
    innovation_.known = true;
    innovation_.scale = std::sqrt(filter.total);
    innovation_.spread = innovation_.scale * std::sqrt(noise);
    innovation_.value = innovation / innovation_.spread;
    innovation_.gain = filter.gain;
  }
  count_ += 1.0;
  choose();
  return innovation_;
}

// The quickest level that may well be the right one: one that is taken for slower than it is looks like
// steps.
void LevelNoise::choose() noexcept {
  const auto likelihood = [&](const Filter& filter) {
    return filter.squares > 0.0 ? -0.5 * (count_ * std::log(filter.squares / count_) + filter.log_variance)
                                : -std::numeric_limits<double>::infinity();
  };
  double best = -std::numeric_limits<double>::infinity();
  for (const Filter& filter : filters_) best = std::max(best, likelihood(filter));
  double quickest = -1.0;
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    if (likelihood(filters_[i]) < best - kUnlikelier) continue;
    const double follows = sum(filters_[i].gain);
    if (follows <= quickest) continue;
    quickest = follows;
    chosen_ = i;
  }
}

}  // namespace ifog
