// SPDX-License-Identifier: Apache-2.0
// Histogram of durations in constant memory, for threads that must not allocate.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace ifog {

// 2^Bits buckets per octave of nanoseconds, up to 2^Octaves.
template <unsigned Bits, unsigned Octaves>
class BasicDurationHistogram {
 public:
  void add(std::int64_t ns) noexcept {
    const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(0, ns));
    ++counts_[std::min(bucket(value), counts_.size() - 1)];
    ++count_;
    max_ns_ = std::max(max_ns_, value);
  }
  void clear() noexcept { *this = BasicDurationHistogram{}; }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double max_us() const noexcept { return static_cast<double>(max_ns_) * 1e-3; }
  // Upper edge of the bucket that contains this quantile (0 … 1); 0 without values.
  [[nodiscard]] double percentile_us(double share) const noexcept {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(count_));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i + 1 < counts_.size() && count_ > 0; ++i) {
      below += counts_[i];
      if (below > wanted || below == count_)
        return static_cast<double>(std::min(upper_edge(i), max_ns_)) * 1e-3;
    }
    return max_us();
  }

 private:
  // Values below 2^Bits have individual buckets; above, the leading one and the bits after it select the
  // bucket.
  static std::size_t bucket(std::uint64_t value) noexcept {
    if (value < (1U << Bits)) return value;
    const auto octave = static_cast<unsigned>(std::bit_width(value)) - 1 - Bits;
    return (static_cast<std::size_t>(octave + 1) << Bits) + ((value >> octave) - (1U << Bits));
  }
  static std::uint64_t upper_edge(std::size_t i) noexcept {
    if (i < (1U << Bits)) return i;
    const std::size_t octave = (i >> Bits) - 1;
    return (((i & ((1U << Bits) - 1)) + (1U << Bits) + 1) << octave) - 1;
  }

  std::array<std::uint32_t, std::size_t{Octaves - Bits + 1} << Bits> counts_{};
  std::uint64_t count_ = 0, max_ns_ = 0;
};

// Percentiles within 3 %, up to an hour.
using DurationHistogram = BasicDurationHistogram<5, 42>;

}  // namespace ifog
