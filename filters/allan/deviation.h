// SPDX-License-Identifier: Apache-2.0
// Overlapping Allan deviation of a rate, from one running sum.
//
// Riley, "Handbook of frequency stability analysis", NIST Special Publication 1065 (2008), equations 10, 15
// and 26; IEEE Std 952 calls the same thing the Allan variance of Ω.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/angle_sum.h"

namespace ifog {

enum class Deviation {
  kAllan,     // second differences of the angle
  kModified,  // the same, averaged over m neighbours: tells white from flicker phase noise
  kHadamard,  // third differences: blind to a rate ramp
};

// Mean square over all places where the difference fits inside one stretch.
struct DeviationPoint {
  std::size_t m = 0;      // averaging time in samples
  std::size_t terms = 0;  // squares averaged; 0: no stretch is long enough
  double variance = 0.0;  // (rad/s)²; NaN when terms is 0
};

// The longest averaging time at which a difference fits into a stretch of so many samples; 0 if none does.
[[nodiscard]] std::size_t longest_average(Deviation kind, std::size_t samples);

// Angles of a long series that are in memory at a time, 128 MiB: the m whose differences fit into so many are
// found in one pass over the file together, longer ones each in a pass of its own.
inline constexpr std::size_t kAnglesAtOnce = std::size_t{1} << 24U;

// One point per entry of m (each >= 1), in that order; on all processors. The same to rounding wherever the
// angles are.
[[nodiscard]] std::vector<DeviationPoint> deviation(const AngleSum& sum, std::span<const std::size_t> m,
                                                    Deviation kind = Deviation::kAllan,
                                                    std::size_t angles_at_once = kAnglesAtOnce);

// Averaging times in samples, `per_decade` to a factor of ten, without repeats, from 1 to longest.
[[nodiscard]] std::vector<std::size_t> log_spaced(std::size_t longest, int per_decade);

}  // namespace ifog
