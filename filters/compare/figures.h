// SPDX-License-Identifier: Apache-2.0
// Figures of a comparison as functions of plain series. NaN entries are ignored.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace ifog {

// Standard deviation about the mean; 0 for fewer than two values.
[[nodiscard]] double spread(std::span<const double> values);

struct AgainstReference {
  std::optional<double> rmse;   // root mean square of output − reference; nullopt if one is always missing
  std::optional<double> bias;   // mean of output − reference
  std::optional<double> lag_s;  // delay of the output; nullopt if the reference does not move enough
};

// The lag is the shift in samples, at most `longest_samples`, with the smallest spread of output − shifted
// reference, refined by a parabola through its neighbours. Of nearly equal minima the one nearest to zero is
// used.
[[nodiscard]] AgainstReference against_reference(std::span<const double> output,
                                                 std::span<const double> reference, double period_s,
                                                 int longest_samples);

struct HeadingClosure {
  double end_rad = 0.0;  // ∫(output − measured)dt over the whole record
  double max_rad = 0.0;  // its largest magnitude
};
[[nodiscard]] HeadingClosure heading_closure(std::span<const double> output, std::span<const double> measured,
                                             std::span<const double> dt_s);

struct Whiteness {
  double lag1 = 0.0;  // autocorrelation at one sample
  double excess = 0.0;  // n Σ ρ_k² / 20, lags 1 … 20: mean 1 for white noise (Box and Pierce, JASA 65, 1970)
};
[[nodiscard]] Whiteness whiteness(std::span<const double> innovations);

// Median; nullopt if more than half of the values are missing.
[[nodiscard]] std::optional<double> median_reached(const std::vector<std::optional<double>>& values);

}  // namespace ifog
