// SPDX-License-Identifier: Apache-2.0
// Allan deviation of arriving data at 1, 2, 4, … samples in constant memory, for the daemon's status.
//
// Each octave keeps its last eight quarter-length averages and takes a difference at each new one.
// Differences overlap by three quarters, so the estimate is within a few per cent as certain as the fully
// overlapping one. A sample costs about two such steps on average, at most one per octave. No allocation,
// lock or exception.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace ifog {

class StreamingAllan {
 public:
  static constexpr int kOctaves = 24;  // 2²³ samples: more than an hour at 2 kHz

  // Adds the next rate, rad/s, one sample time after the one before. A value that is not finite acts as a
  // gap.
  void add(double rate_radps) noexcept {
    if (!std::isfinite(rate_radps)) return restart();
    // Subtracting the first value keeps the digits of the noise if the bias is much larger.
    if (!started_) offset_ = rate_radps;
    started_ = true;
    double mean = rate_radps - offset_;
    for (int k = 0; k < kOctaves; ++k) {
      Level& level = level_[static_cast<std::size_t>(k)];
      level.push(mean);
      if (k == 0) {
        take<1>(0, level);
        take<2>(1, level);
      }
      if (k + 2 < kOctaves) take<4>(k + 2, level);
      if ((level.filled & 1U) != 0) return;  // only half of the next level's average is complete
      mean = 0.5 * (level.at(0) + level.at(1));
    }
  }

  // To be called after a gap: no difference reaches across it. The sums are kept.
  void restart() noexcept {
    for (Level& level : level_) level.filled = 0;
    started_ = false;
  }

  // Allan deviation at 2^octave samples, rad/s; NaN before the first difference.
  [[nodiscard]] double deviation(int octave) const noexcept {
    const Sum& sum = sum_[static_cast<std::size_t>(octave)];
    return sum.count == 0 ? std::numeric_limits<double>::quiet_NaN()
                          : std::sqrt(0.5 * sum.squares / static_cast<double>(sum.count));
  }
  [[nodiscard]] std::uint64_t differences(int octave) const noexcept {
    return sum_[static_cast<std::size_t>(octave)].count;
  }
  // Number of octaves that have at least one difference.
  [[nodiscard]] int octaves() const noexcept {
    int n = 0;
    while (n < kOctaves && sum_[static_cast<std::size_t>(n)].count > 0) ++n;
    return n;
  }

 private:
  // The last eight means of 2^k samples; index 0 is the newest.
  struct Level {
    std::array<double, 8> ring{};
    std::uint64_t filled = 0;
    void push(double mean) noexcept { ring[filled++ & 7U] = mean; }
    [[nodiscard]] double at(std::uint64_t age) const noexcept { return ring[(filled - 1 - age) & 7U]; }
  };
  struct Sum {
    double squares = 0.0;
    std::uint64_t count = 0;
  };

  // kUnits: means per average, a power of two.
  template <std::uint64_t kUnits>
  void take(int octave, const Level& level) noexcept {
    if (level.filled < 2 * kUnits) return;
    double difference = 0.0;
    for (std::uint64_t u = 0; u < kUnits; ++u) difference += level.at(u) - level.at(u + kUnits);
    difference *= 1.0 / static_cast<double>(kUnits);
    Sum& sum = sum_[static_cast<std::size_t>(octave)];
    sum.squares += difference * difference;
    ++sum.count;
  }

  std::array<Level, kOctaves> level_{};
  std::array<Sum, kOctaves> sum_{};
  double offset_ = 0.0;
  bool started_ = false;
};

}  // namespace ifog
