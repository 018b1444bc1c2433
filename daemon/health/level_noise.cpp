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
// The choice is made again when the number of blocks has grown by a twentieth.
constexpr double kChosenAnew = 1.05;

double sum(const LevelNoise::Vector& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::vector<LevelFilters::Ratios> table() {
  std::vector<LevelFilters::Ratios> out;
  for (int b = 0; b < kInstabilities; ++b)
    for (int k = 0; k < kWalks; ++k)
      out.push_back({b == 0 ? 0.0 : std::pow(10.0, kLeastInstability + kStepOfTable * (b - 1)),
                     k == 0 ? 0.0 : std::pow(10.0, kLeastWalk + kStepOfTable * (k - 1))});
  return out;
}

}  // namespace

LevelNoise::LevelNoise() : filters_(table()) {}

double LevelNoise::level() const noexcept {
  return has_level_ ? filters_.level(chosen_) : std::numeric_limits<double>::quiet_NaN();
}

// squares: of the filter in use, before this mean. The noise is not known better than the blocks so far
// allow: its variance as large as two standard errors make it.
void LevelNoise::innovate(double squares) noexcept {
  const double noise = count_ > 0.0 ? squares / count_ * (1.0 + kTwoErrors * std::sqrt(2.0 / count_)) : 0.0;
  if (!(noise > 0.0)) return;
  innovation_.known = true;
  innovation_.scale = std::sqrt(filters_.total(chosen_));
  innovation_.spread = innovation_.scale * std::sqrt(noise);
  innovation_.value = filters_.innovation(chosen_) / innovation_.spread;
  innovation_.gain = filters_.gain(chosen_);
}

const LevelNoise::Innovation& LevelNoise::take(double mean, double blocks) noexcept {
  innovation_.known = false;
  if (!has_level_) {
    filters_.begin(mean);
    has_level_ = true;
    return innovation_;
  }
  innovation_.keep[kWalk] = 1.0;
  for (std::size_t i = 0; i < kWalk; ++i) innovation_.keep[i] = std::exp(-blocks / kTimes[i]);
  const double squares = filters_.squares(chosen_);
  filters_.take(mean, blocks, innovation_.keep, count_ > kFew ? count_ : 0.0, kClip);
  innovate(squares);
  count_ += 1.0;
  if (count_ >= kChosenAnew * chosen_at_) choose();
  return innovation_;
}

// The quickest level that may well be the right one: one that is taken for slower than it is looks like
// steps.
void LevelNoise::choose() noexcept {
  chosen_at_ = count_;
  std::vector<double> likelihood(filters_.size());
  for (std::size_t i = 0; i < filters_.size(); ++i)
    likelihood[i] = filters_.squares(i) > 0.0
                        ? -0.5 * (count_ * std::log(filters_.squares(i) / count_) + filters_.log_variance(i))
                        : -std::numeric_limits<double>::infinity();
  const double best = *std::max_element(likelihood.begin(), likelihood.end());
  double quickest = -1.0;
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    if (likelihood[i] < best - kUnlikelier) continue;
    const double follows = sum(filters_.gain(i));
    if (follows <= quickest) continue;
    quickest = follows;
    chosen_ = i;
  }
}

}  // namespace ifog
