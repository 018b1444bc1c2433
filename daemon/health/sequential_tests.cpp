// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/sequential_tests.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ifog {
namespace {

// Odds of UsualCusum.
constexpr double kBefore = 0.01, kAfter = 0.9;
// Siegmund's 0.583 in nu, squared.
constexpr double kOvershoot = 2.0 * 0.583;
// As many units of log likelihood below the best as two standard errors are.
constexpr double kTwoErrors = 2.0;

// Of x exp(-kOvershoot x), from x on.
double tail(double x) {
  return (x / kOvershoot + 1.0 / (kOvershoot * kOvershoot)) * std::exp(-kOvershoot * x);
}

}  // namespace

double window_blocks(double threshold, std::size_t windows) {
  const double c = threshold;
  const double integral = tail(c / std::sqrt(static_cast<double>(windows))) - tail(c);
  // One window: crossings of a white series, two-sided.
  if (windows < 2) return 1.0 / std::erfc(c / std::numbers::sqrt2);
  return std::sqrt(2.0 * std::numbers::pi) * std::exp(0.5 * c * c) / (c * integral);
}

double window_threshold(double blocks, std::size_t windows) {
  double low = 2.0, high = 12.0;
  for (int halvings = 0; halvings < 60; ++halvings) {
    const double middle = 0.5 * (low + high);
    (window_blocks(middle, windows) < blocks ? low : high) = middle;
  }
  return high;
}

void UsualCusum::take(bool odd) noexcept {
  static const double up = std::log(kAfter / kBefore), down = std::log((1.0 - kAfter) / (1.0 - kBefore));
  // No further than it takes as long to come back as it took to rise.
  sum_ = std::clamp(sum_ + (odd ? up : down), 0.0, 2.0 * threshold_);
  if (sum_ > threshold_) alarmed_ = true;
  if (sum_ == 0.0) alarmed_ = false;
}

void ColourCusum::take(double value) noexcept {
  if (known_)
    sum_ = std::clamp(sum_ + kFollows * last_ * value - 0.5 * kFollows * kFollows * last_ * last_, 0.0,
                      2.0 * threshold_);
  last_ = value;
  known_ = true;
  if (sum_ > threshold_) alarmed_ = true;
  if (sum_ == 0.0) alarmed_ = false;
}

void StepTest::restart() noexcept {
  begun_ = 0;
  largest_ = 0.0;
}

// Windows of n blocks that begin at each block overlap: n of them are one.
double StepTest::variance(std::size_t blocks) const noexcept {
  const Spread& seen = spreads_[blocks - 1];
  const double independent = seen.count / static_cast<double>(blocks);
  return std::max(1.0, seen.mean_square * (1.0 + kTwoErrors * std::sqrt(2.0 / std::max(2.0, independent))));
}

bool StepTest::take(double innovation, double gain, double spread) noexcept {
  windows_[begun_++ % kWindows] = {};
  double greatest = 0.0, step = 0.0;
  const std::size_t in_use = std::min(begun_, kWindows);
  for (std::size_t i = 0; i < in_use; ++i) {
    Window& window = windows_[i];
    window.sum += window.weight * innovation;
    window.squares += window.weight * window.weight;
    window.weight *= 1.0 - gain;
    ++window.blocks;
    const double z = std::abs(window.sum) / std::sqrt(window.squares * variance(window.blocks));
    if (z <= greatest) continue;
    greatest = z;
    step = window.sum / window.squares * spread;
  }
  largest_ = std::max(largest_, greatest);
  if (greatest > threshold_) {
    step_ = step;
    begun_ = 0;
    return true;
  }
  for (std::size_t i = 0; i < in_use; ++i) {
    const Window& window = windows_[i];
    Spread& seen = spreads_[window.blocks - 1];
    seen.count += 1.0;
    seen.mean_square += (window.sum * window.sum / window.squares - seen.mean_square) / seen.count;
  }
  return false;
}

LevelNoise::LevelNoise() {
  for (std::size_t i = 0; i < kRatios; ++i)
    filters_[i].ratio = std::pow(10.0, -7.0 + 0.5 * static_cast<double>(i));
}

double LevelNoise::level() const noexcept {
  return has_level_ ? filters_[chosen_].level : std::numeric_limits<double>::quiet_NaN();
}

LevelNoise::Innovation LevelNoise::take(double mean, double blocks) noexcept {
  if (!has_level_) {
    for (Filter& filter : filters_) {
      filter.level = mean;
      filter.variance = 1.0;
    }
    has_level_ = true;
    return {};
  }
  Innovation out;
  for (std::size_t i = 0; i < kRatios; ++i) {
    Filter& filter = filters_[i];
    filter.variance += filter.ratio * blocks;
    const double total = filter.variance + 1.0, gain = filter.variance / total;
    const double innovation = mean - filter.level;
    if (i == chosen_ && count_ > 0.0 && filter.squares > 0.0) {
      // The noise is not known better than the blocks so far allow: its variance as large as two standard
      // errors make it.
      const double noise = filter.squares / count_ * (1.0 + kTwoErrors * std::sqrt(2.0 / count_));
      out.spread = std::sqrt(total * noise);
      out = {true, innovation / out.spread, out.spread, gain};
    }
    filter.squares += innovation * innovation / total;
    filter.log_variance += std::log(total);
    filter.level += gain * innovation;
    filter.variance = gain;
  }
  count_ += 1.0;
  choose();
  return out;
}

// The quickest walk that is not surely too quick: one that is taken for slower than it is looks like steps.
void LevelNoise::choose() noexcept {
  std::array<double, kRatios> likelihood{};
  for (std::size_t i = 0; i < kRatios; ++i) {
    const Filter& filter = filters_[i];
    likelihood[i] = filter.squares > 0.0
                        ? -0.5 * (count_ * std::log(filter.squares / count_) + filter.log_variance)
                        : -std::numeric_limits<double>::infinity();
  }
  const double best = *std::max_element(likelihood.begin(), likelihood.end());
  for (std::size_t i = 0; i < kRatios; ++i)
    if (likelihood[i] >= best - kTwoErrors) chosen_ = i;
}

}  // namespace ifog
