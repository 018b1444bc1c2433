// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/step_test.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ifog {
namespace {

double density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); }
double distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

// Number of independent sums before their variance is estimated; until then it is that of white innovations.
constexpr double kBelieved = 100.0;
// Sums are weighted by their number, the newest most, since the filter in use changes while it learns: with
// weights 1 … n the mean is as accurate as that of 0.75 n sums.
constexpr double kNewestWeighs = 2.0, kKnownAs = 0.75;
// Smaller values are ignored.
constexpr double kLeastOfNote = 2.5;
constexpr double kFar = 1e9;

// Squared sum / its variance, converted from known degrees of freedom. The variance is that of white
// innovations, or more if the level's noise is not in the table, or less if the filter assumes a too fast
// level. It is estimated from so many sums, so this is a squared Student's t; returns the normal square of
// about equal probability (D. L. Wallace, Ann. Math. Statist. 30, 1959).
double as_of_known_variance(double square, double mean_square, double independent) {
  const double known_by = kBelieved + independent;
  return known_by * std::log1p(square / (kBelieved + independent * mean_square));
}

// Mean number of new excesses of |z| > 1 per block; s: 1 - correlation of neighbours, in (0, 1].
double exceeded_per_block(double z, double s) {
  const double x = z * std::sqrt(2.0 * s);
  const double nu =
      2.0 / x * (distribution(0.5 * x) - 0.5) / (0.5 * x * distribution(0.5 * x) + density(0.5 * x));
  return 2.0 * z * density(z) * s * nu;
}

}  // namespace

void StepTest::extend(Window& window, const LevelNoise::Innovation& innovation) noexcept {
  double left = 1.0;
  for (std::size_t i = 0; i < LevelNoise::kStates; ++i) left -= window.absorbed[i] *= innovation.keep[i];
  const double weight = left / innovation.scale;
  window.sum += weight * innovation.value;
  window.squares += weight * weight;
  window.neighbours += weight * window.weight;
  window.weight = weight;
  for (std::size_t i = 0; i < LevelNoise::kStates; ++i) window.absorbed[i] += innovation.gain[i] * left;
}

// Expected number of such values / that of false alarms allowed.
double StepTest::look(std::size_t number) noexcept {
  const Window& window = windows_[(begun_ - kLengths[number]) % kLongest];
  Spread& seen = spreads_[number];
  const double s = std::clamp(1.0 - window.neighbours / window.squares, 1e-3, 1.0);
  const double square = window.sum * window.sum / window.squares;
  const double z = std::sqrt(as_of_known_variance(square, seen.mean_square, kKnownAs * s * seen.count));
  seen.latest = square;
  if (z < kLeastOfNote) return kFar;
  return exceeded_per_block(z, s) / (kShares[number] * alarms_per_block_);
}

bool StepTest::take(const LevelNoise::Innovation& innovation) noexcept {
  windows_[begun_++ % kLongest] = {};
  const std::size_t in_use = std::min(begun_, kLongest);
  for (std::size_t i = 0; i < in_use; ++i) extend(windows_[i], innovation);
  double nearest = kFar;
  for (std::size_t i = 0; i < kLengths.size() && kLengths[i] <= begun_; ++i)
    nearest = std::min(nearest, look(i));
  if (nearest >= 1.0) {
    // A step must not change the noise by which the next one is tested.
    for (std::size_t i = 0; i < kLengths.size() && kLengths[i] <= begun_; ++i) {
      spreads_[i].count += 1.0;
      spreads_[i].mean_square +=
          kNewestWeighs / (spreads_[i].count + 1.0) * (spreads_[i].latest - spreads_[i].mean_square);
    }
    return false;
  }
  step_ = likeliest(in_use) * innovation.spread / innovation.scale;
  begun_ = 0;
  return true;
}

// Most likely first block of the step.
double StepTest::likeliest(std::size_t in_use) const noexcept {
  const auto* const best = std::max_element(
      windows_.begin(), windows_.begin() + static_cast<std::ptrdiff_t>(in_use),
      [](const Window& a, const Window& b) { return a.sum * a.sum * b.squares < b.sum * b.sum * a.squares; });
  return best->sum / best->squares;
}

}  // namespace ifog
