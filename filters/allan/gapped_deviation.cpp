// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/gapped_deviation.h"

#include <algorithm>
#include <cmath>

#include "filters/allan/deviation.h"
#include "filters/series/samples.h"

namespace ifog {
namespace {

// Running sums relative to the first value, and counts of values.
struct GappedSum {
  Samples sum, there;

  explicit GappedSum(std::span<const double> rate) : sum(rate.size() + 1, 0.0), there(rate.size() + 1, 0.0) {
    const auto first = std::ranges::find_if(rate, [](double v) { return std::isfinite(v); });
    const double offset = first == rate.end() ? 0.0 : *first;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      const bool finite = std::isfinite(rate[i]);
      sum[i + 1] = sum[i] + (finite ? rate[i] - offset : 0.0);
      there[i + 1] = there[i] + (finite ? 1.0 : 0.0);
    }
  }

  [[nodiscard]] double deviation(std::size_t m) const {
    double square = 0.0, n = 0.0;
    const double least = 0.5 * static_cast<double>(m);
    for (std::size_t i = 0; i + 2 * m < sum.size(); ++i) {
      const double one = there[i + m] - there[i];
      const double other = there[i + 2 * m] - there[i + m];
      if (one < least || other < least) continue;
      const double d = (sum[i + 2 * m] - sum[i + m]) / other - (sum[i + m] - sum[i]) / one;
      square += d * d;
      n += 1.0;
    }
    return n > 0.0 ? std::sqrt(0.5 * square / n) : std::nan("");
  }
};

}  // namespace

std::vector<double> gapped_deviation(std::span<const double> rate_radps, std::span<const std::size_t> m) {
  std::vector<double> found;
  found.reserve(m.size());
  if (std::ranges::all_of(rate_radps, [](double v) { return std::isfinite(v); })) {
    const std::vector<Stretch> whole = {{0, rate_radps.size()}};
    for (const DeviationPoint& point : deviation(AngleSum(rate_radps, whole), m, Deviation::kAllan))
      found.push_back(std::sqrt(point.variance));
  } else {
    const GappedSum sums(rate_radps);
    for (const std::size_t each : m) found.push_back(sums.deviation(each));
  }
  for (std::size_t i = 0; i < m.size(); ++i)
    if (rate_radps.size() < 3 * m[i]) found[i] = std::nan("");
  return found;
}

}  // namespace ifog
