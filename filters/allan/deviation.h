// SPDX-License-Identifier: Apache-2.0
// Overlapping Allan deviation of a rate, from one running sum.
//
// Riley, "Handbook of frequency stability analysis", NIST Special Publication 1065 (2008), equations 10, 15
// and 26; IEEE Std 952 calls the same thing the Allan variance of Ω.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "filters/allan/angle_sum.h"

namespace ifog {

enum class Deviation {
  kAllan,     // second differences of the angle
  kModified,  // the same, averaged over m neighbours: separates white from flicker phase noise
  kHadamard,  // third differences: not affected by a rate ramp
};

// Mean square over all places where the difference fits into one stretch.
struct DeviationPoint {
  std::size_t m = 0;      // averaging time in samples
  std::size_t terms = 0;  // squares averaged; 0: no stretch is long enough
  double variance = 0.0;  // (rad/s)²; NaN when terms is 0
};

// Longest averaging time in samples at which a difference fits into a stretch of `samples`; 0 if none does.
[[nodiscard]] std::size_t longest_average(Deviation kind, std::size_t samples);

// Number of places where a difference fits into a stretch of `samples`.
[[nodiscard]] std::size_t differences_of(Deviation kind, std::size_t m, std::size_t samples);

// One point per entry of m (each >= 1), in that order, computed on all processors.
[[nodiscard]] std::vector<DeviationPoint> deviation(const AngleSum& sum, std::span<const std::size_t> m,
                                                    Deviation kind = Deviation::kAllan);

// Averaging times that commands report, s.
inline constexpr std::array<double, 4> kReportedTaus{0.1, 1.0, 10.0, 100.0};
// Overlapping Allan deviation at each; nullopt: no multiple of the sample time within a tenth of it, or no difference
// fits into a stretch.
using ReportedDeviations = std::array<std::optional<double>, kReportedTaus.size()>;
[[nodiscard]] ReportedDeviations reported_deviations(std::span<const double> rate_radps,
                                                     std::span<const Stretch> parts, double period_s);

// Averaging times in samples from 1 to longest, `per_decade` per decade, without repeats.
[[nodiscard]] std::vector<std::size_t> log_spaced(std::size_t longest, int per_decade);

}  // namespace ifog
