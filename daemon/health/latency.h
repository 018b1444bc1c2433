// SPDX-License-Identifier: Apache-2.0
// Distribution of latencies in constant memory: buckets of an eighth of an octave, so a percentile is right
// within 9 %.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ifog {

class LatencyHistogram {
 public:
  void add(std::int64_t ns) noexcept {
    const std::uint64_t clipped = ns < 1 ? 1 : static_cast<std::uint64_t>(ns);
    ++count_[bucket(clipped)];
    ++total_;
    if (clipped > max_ns_) max_ns_ = clipped;
  }
  void clear() noexcept { *this = LatencyHistogram{}; }

  [[nodiscard]] std::uint64_t count() const noexcept { return total_; }
  [[nodiscard]] double max_us() const noexcept { return static_cast<double>(max_ns_) * 1e-3; }
  // Upper edge of the bucket that holds the fraction p of all; 0 when empty.
  [[nodiscard]] double percentile_us(double p) const noexcept {
    const double wanted = p * static_cast<double>(total_);
    double seen = 0.0;
    for (std::size_t b = 0; total_ > 0 && b < count_.size(); ++b) {
      seen += count_[b];
      if (seen < wanted) continue;
      const double octave = std::ldexp(1.0, static_cast<int>(b / kPerOctave));
      const double edge = octave * (1.0 + static_cast<double>(b % kPerOctave + 1) / kPerOctave);
      return std::min(edge, static_cast<double>(max_ns_)) * 1e-3;
    }
    return max_us();
  }

 private:
  static constexpr std::size_t kOctaves = 40, kPerOctave = 8;
  static std::size_t bucket(std::uint64_t ns) noexcept {
    const auto octave = static_cast<std::size_t>(std::bit_width(ns)) - 1;
    if (octave >= kOctaves) return kOctaves * kPerOctave - 1;
    const std::uint64_t fraction = octave >= 3 ? (ns >> (octave - 3)) & 7u : (ns << (3 - octave)) & 7u;
    return octave * kPerOctave + static_cast<std::size_t>(fraction);
  }
  std::array<std::uint32_t, kOctaves * kPerOctave> count_{};
  std::uint64_t total_ = 0;
  std::uint64_t max_ns_ = 0;
};

}  // namespace ifog
