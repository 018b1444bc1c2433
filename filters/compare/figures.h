// SPDX-License-Identifier: Apache-2.0
// Single figures of a comparison, each a function of plain series. NaN entries are ignored.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace ifog {

// Standard deviation about the mean; 0 for fewer than two values.
[[nodiscard]] double spread(std::span<const double> values);

struct AgainstReference {
  std::optional<double> rmse;  // root mean square of output − reference; nothing where one is always missing
  std::optional<double> bias;  // mean of output − reference
  std::optional<double>
      lag_s;  // how far the output trails; nothing when the reference does not move enough to tell
};

// The lag is the shift in whole samples, up to `longest_samples`, that makes the spread of output − shifted
// reference smallest, refined by the parabola through its neighbours; of several that are all but as good the
// nearest to none.
[[nodiscard]] AgainstReference against_reference(std::span<const double> output,
                                                 std::span<const double> reference, double period_s,
                                                 int longest_samples);

struct HeadingClosure {
  double end_rad = 0.0;  // ∫(output − measured)dt over the whole record
  double max_rad = 0.0;  // its largest excursion from zero
};
[[nodiscard]] HeadingClosure heading_closure(std::span<const double> output, std::span<const double> measured,
                                             std::span<const double> dt_s);

struct Whiteness {
  double lag1 = 0.0;  // autocorrelation at one sample
  double excess = 0.0;  // n Σ ρ_k² / 20, lags 1 … 20: mean 1 for white noise (Box and Pierce, JASA 65, 1970)
};
[[nodiscard]] Whiteness whiteness(std::span<const double> innovations);

// Middle value; nothing when more than half are missing, for then the median is not known either.
[[nodiscard]] std::optional<double> median_reached(const std::vector<std::optional<double>>& values);

}  // namespace ifog
