#include "filters/estimator/innovation_monitor.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

// Two standard errors of the scale.
constexpr double kScaleMargin = 1.5;
// Innovations this much larger than third differences allow mean motion, not noise.
constexpr double kMovedRatio = 2.0;
// The same while running. Noise correlated by 0.6 from sample to sample reaches it.
constexpr double kMostOverStill = 4.0;

// What was measured over thousands of samples may have been this much too small.
constexpr double kAllowance = 1.25;
// What a single sum may say about the colour, in squared sigmas: a manoeuvre about to be found is none.
constexpr double kColourClip = 16.0;

template <std::size_t n>
constexpr std::array<double, n> inverses(const std::array<int, n>& ladder) {
  std::array<double, n> all{};
  for (std::size_t i = 0; i < n; ++i) all[i] = 1.0 / ladder[i];
  return all;
}

}  // namespace

InnovationMonitor::Verdict InnovationMonitor::test(std::span<const double> innovations,
                                                   std::uint32_t valid_axes, bool at_rest) noexcept {
  static constexpr auto kInverse = inverses(kLadder);
  Verdict verdict;
  const std::size_t before = at_;
  at_ = (at_ + 1) % kRing;
  length_ = std::min(length_ + 1, static_cast<int>(kRing) - 1);
  double greatest = threshold_ * threshold_;
  const bool learns = armed_ && at_rest && --until_colour_ <= 0;
  if (learns) until_colour_ = kColourEvery;
  const bool tailed = tails_ > kTails;
  const double clip = tailed ? kTailClip : kClip;
  const double outlier = tailed ? kTailOutlier : kClip;
  bool beyond = false;
  for (std::size_t axis = 0; axis < innovations.size(); ++axis) {
    std::array<double, kRing>& sums = sums_[axis];
    const bool valid = (valid_axes >> axis & 1U) != 0 && variance_[axis] > 0.0 && !still_learns(axis);
    const double normalised = valid ? innovations[axis] / std::sqrt(variance_[axis]) : 0.0;
    sums[at_] = sums[before] + std::clamp(normalised, -clip, clip);
    if (!armed_) continue;
    beyond = beyond || std::abs(normalised) > kClip;
    verdict.suspect = verdict.suspect || std::abs(normalised) > outlier;
    for (std::size_t rung = 0; rung < kLadder.size() && kLadder[rung] <= length_; ++rung) {
      const auto m = static_cast<std::size_t>(kLadder[rung]);
      const double sum = sums[at_] - sums[(at_ + kRing - m) % kRing];
      const double white = sum * sum * kInverse[rung];  // square of the statistic if the noise is white
      if (white <= kCalm * kCalm) continue;             // the colour only ever makes it smaller
      const double square = white / colour_[axis].widening[rung];
      verdict.calm = verdict.calm && square <= kCalm * kCalm;
      if (square > greatest) {
        greatest = square;
        verdict.changed_since = kLadder[rung];
      }
    }
    if (learns && valid) learn_colour(axis);
  }
  if (armed_ && at_rest) tails_ += ((beyond ? 1.0 : 0.0) - tails_) / kTailMemory;
  if (verdict.changed_since > 0) verdict.suspect = false;
  return verdict;
}

void InnovationMonitor::learn_colour(std::size_t axis) noexcept {
  Colour& colour = colour_[axis];
  colour.count = std::min(colour.count + 1.0, kColourMemory);
  const double share = 1.0 / colour.count;
  for (std::size_t rung = 0; rung < kLadder.size() && kLadder[rung] <= length_; ++rung) {
    const auto m = static_cast<std::size_t>(kLadder[rung]);
    const double sum = sums_[axis][at_] - sums_[axis][(at_ + kRing - m) % kRing];
    double& variance = colour.variance[rung];
    const double square = sum * sum / kLadder[rung];
    variance += share * (std::min(square, kColourClip * std::max(variance, 1.0)) - variance);
    // Relative error of such a variance; sums that overlap count for fewer.
    const double overlap = std::max(1.0, 2.0 * kLadder[rung] / (3.0 * kColourEvery));
    const double certain = variance / (1.0 + 2.0 * std::sqrt(2.0 * overlap * share));
    colour.widening[rung] = std::clamp(certain, 1.0, colour.most);
  }
}

void InnovationMonitor::allow(std::size_t axis, double variance, double widening) noexcept {
  allowed_[axis] = kAllowance * variance;
  colour_[axis].most = std::max(kMostColour, kAllowance * widening);
}

void InnovationMonitor::adopt(std::size_t axis, double variance, double widening) noexcept {
  allow(axis, variance, widening);
  variance_[axis] = variance;
  Colour& colour = colour_[axis];
  colour.count = kColourMemory / 8.0;
  for (std::size_t rung = 0; rung < kLadder.size(); ++rung) {
    // The sum of m samples varies m times as much as white noise's at most.
    const double wide = std::clamp(kAllowance * widening, 1.0, static_cast<double>(kLadder[rung]));
    colour.variance[rung] = colour.widening[rung] = wide;
  }
}

bool InnovationMonitor::learn(std::size_t axis, double innovation, double factor) noexcept {
  double square = innovation * innovation / factor;
  if (armed_ && !still_learns(axis)) square = std::min(square, kClip * kClip * variance_[axis]);
  if (learned_[axis] < kMemory) {
    learned_[axis] += 1.0;
    threshold_ = kThreshold * (1.0 + kScaleMargin / std::sqrt(learned_[axis]));
  }
  variance_[axis] += (square - variance_[axis]) / learned_[axis];
  if (armed_) {
    if (still_[axis].count >= kMemory)
      variance_[axis] =
          std::min(variance_[axis], std::max(kMostOverStill * still_[axis].variance, allowed_[axis]));
    return false;
  }
  if (learned_[axis] < kLearning) return false;
  armed_ = true;
  bool moved = false;
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    const Still& still = still_[a];
    if (still.count < kLearning / 2.0 || variance_[a] <= kMovedRatio * still.variance) continue;
    variance_[a] = still.variance;
    moved = true;
  }
  return moved;
}

void InnovationMonitor::learn_still(std::size_t axis, double rate) noexcept {
  Still& still = still_[axis];
  if (still.count >= 3.0) {
    const double third = rate - 3.0 * still.last[2] + 3.0 * still.last[1] - still.last[0];
    double variance = third * third / 20.0;
    // Like the scale itself. Beside the scale, so that a coarse sensor's runs of equal values do not end in a
    // variance of zero that nothing could raise again.
    if (armed_ && !still_learns(axis))
      variance = std::min(variance, kClip * kClip * std::max(still.variance, 0.5 * variance_[axis]));
    still.variance += (variance - still.variance) / (still.count - 2.0);
  }
  still.count = std::min(still.count + 1.0, kMemory + 3.0);
  still.last = {still.last[1], still.last[2], rate};
}

}  // namespace ifog
