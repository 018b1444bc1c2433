#include "filters/estimator/innovation_monitor.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

// Two standard errors of the scale.
constexpr double kScaleMargin = 1.5;
// Innovations this much larger than third differences allow mean motion, not noise.
constexpr double kMovedRatio = 2.0;

// 1/sqrt(m) of the ladder, so that the step divides by nothing.
template <std::size_t n>
std::array<double, n> inverse_roots(const std::array<int, n>& ladder) {
  std::array<double, n> roots{};
  for (std::size_t i = 0; i < n; ++i) roots[i] = 1.0 / std::sqrt(static_cast<double>(ladder[i]));
  return roots;
}

}  // namespace

InnovationMonitor::Verdict InnovationMonitor::test(std::span<const double> innovations,
                                                   std::uint32_t valid_axes) noexcept {
  static const std::array<double, kLadder.size()> kRoots = inverse_roots(kLadder);
  Verdict verdict;
  const std::size_t before = at_;
  at_ = (at_ + 1) % kRing;
  length_ = std::min(length_ + 1, static_cast<int>(kRing) - 1);
  double greatest = threshold_;
  for (std::size_t axis = 0; axis < innovations.size(); ++axis) {
    std::array<double, kRing>& sums = sums_[axis];
    const bool valid = (valid_axes >> axis & 1U) != 0 && variance_[axis] > 0.0;
    const double normalised = valid ? innovations[axis] / std::sqrt(variance_[axis]) : 0.0;
    sums[at_] = sums[before] + std::clamp(normalised, -kClip, kClip);
    if (!armed_) continue;
    verdict.suspect = verdict.suspect || std::abs(normalised) > kClip;
    for (std::size_t rung = 0; rung < kLadder.size() && kLadder[rung] <= length_; ++rung) {
      const auto m = static_cast<std::size_t>(kLadder[rung]);
      const double statistic = std::abs(sums[at_] - sums[(at_ + kRing - m) % kRing]) * kRoots[rung];
      if (statistic > greatest) {
        greatest = statistic;
        verdict.changed_since = kLadder[rung];
      }
    }
  }
  if (verdict.changed_since > 0) verdict.suspect = false;
  return verdict;
}

bool InnovationMonitor::learn(std::size_t axis, double innovation, double factor) noexcept {
  double square = innovation * innovation / factor;
  if (armed_) square = std::min(square, kClip * kClip * variance_[axis]);
  if (learned_[axis] < kMemory) {
    learned_[axis] += 1.0;
    threshold_ = kThreshold * (1.0 + kScaleMargin / std::sqrt(learned_[axis]));
  }
  variance_[axis] += (square - variance_[axis]) / learned_[axis];
  if (armed_ || learned_[axis] < kLearning) return false;
  armed_ = true;
  bool moved = false;
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    const Start& start = start_[a];
    if (start.count < kLearning / 2) continue;
    const double still = start.squares / (20.0 * (start.count - 3));
    if (variance_[a] <= kMovedRatio * still) continue;
    variance_[a] = still;
    moved = true;
  }
  return moved;
}

void InnovationMonitor::learn_start(std::size_t axis, double rate) noexcept {
  if (armed_) return;
  Start& start = start_[axis];
  if (start.count >= 3) {
    const double third = rate - 3.0 * start.last[2] + 3.0 * start.last[1] - start.last[0];
    start.squares += third * third;
  }
  ++start.count;
  start.last = {start.last[1], start.last[2], rate};
}

}  // namespace ifog
