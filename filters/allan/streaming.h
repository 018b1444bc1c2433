// SPDX-License-Identifier: Apache-2.0
// Allan deviation while the data arrive: averaging times of 1, 2, 4, … samples in constant memory, for the
// daemon's status.
//
// Each octave keeps its last eight quarter-length averages and takes a difference at every new one, so that
// neighbouring differences overlap by three quarters: within a few per cent as certain as the fully
// overlapping estimate, at eight additions per difference. One sample costs about two such steps on average
// and one per octave at most; no allocation, lock or exception.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace ifog {

class StreamingAllan {
 public:
  static constexpr int kOctaves = 24;  // 2²³ samples: an hour and more at 2 kHz

  // The next rate, rad/s, one sample time after the one before. A value that is not finite breaks the series
  // like a gap.
  void add(double rate_radps) noexcept {
    if (!std::isfinite(rate_radps)) return restart();
    // Differences do not care for a common offset, but their digits do: a bias a million times the noise
    // stays out.
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
      if ((level.filled & 1U) != 0) return;  // half of the next level's average
      mean = 0.5 * (level.at(0) + level.at(1));
    }
  }

  // After a gap: no difference reaches across. What was found so far stays.
  void restart() noexcept {
    for (Level& level : level_) level.filled = 0;
    started_ = false;
  }

  // Allan deviation at 2^octave samples, rad/s; NaN until the first difference.
  [[nodiscard]] double deviation(int octave) const noexcept {
    const Sum& sum = sum_[static_cast<std::size_t>(octave)];
    return sum.count == 0 ? std::numeric_limits<double>::quiet_NaN()
                          : std::sqrt(0.5 * sum.squares / static_cast<double>(sum.count));
  }
  [[nodiscard]] std::uint64_t differences(int octave) const noexcept {
    return sum_[static_cast<std::size_t>(octave)].count;
  }
  // Octaves that have at least one difference: the first so many of them.
  [[nodiscard]] int octaves() const noexcept {
    int n = 0;
    while (n < kOctaves && sum_[static_cast<std::size_t>(n)].count > 0) ++n;
    return n;
  }

 private:
  // The last eight means of 2^k samples, newest at 0.
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

  // kUnits: of the level, a power of two.
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
