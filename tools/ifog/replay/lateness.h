// SPDX-License-Identifier: Apache-2.0
// A histogram of durations in fixed memory: 32 buckets an octave, so that a percentile is right to 3 %. For
// runs of any length that must not allocate.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace ifog::tools {

class Lateness {
 public:
  void add(std::int64_t ns) {
    const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(0, ns));
    ++counts_[bucket(value)];
    ++count_;
    max_ = std::max(max_, value);
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::uint64_t max_ns() const { return max_; }
  // The upper edge of the bucket that holds the given share (0 … 1) of all values; 0 when there are none.
  [[nodiscard]] std::uint64_t percentile_ns(double share) const {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(count_));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      below += counts_[i];
      if (below > wanted || (below == count_ && below > 0)) return std::min(upper_edge(i), max_);
    }
    return max_;
  }

 private:
  static constexpr unsigned kBits = 5;
  static constexpr std::size_t kBuckets = (64 - kBits + 1) << kBits;

  // Values below 2^5 have a bucket each; above, the leading one and the five bits after it pick the bucket.
  static std::size_t bucket(std::uint64_t value) {
    if (value < (1U << kBits)) return value;
    const auto octave = static_cast<unsigned>(std::bit_width(value)) - 1 - kBits;
    return (static_cast<std::size_t>(octave + 1) << kBits) + ((value >> octave) - (1U << kBits));
  }
  static std::uint64_t upper_edge(std::size_t i) {
    if (i < (1U << kBits)) return i;
    const std::size_t octave = (i >> kBits) - 1;
    return (((i & ((1U << kBits) - 1)) + (1U << kBits) + 1) << octave) - 1;
  }

  std::array<std::uint64_t, kBuckets> counts_{};
  std::uint64_t count_ = 0, max_ = 0;
};

}  // namespace ifog::tools
