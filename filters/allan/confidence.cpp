// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/confidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ifog {

AllanInterval interval_of(double variance, std::span<const WeightedChiSquared> law, double confidence) {
  AllanInterval interval;
  interval.degrees = equivalent_degrees(law);
  interval.lower_radps = interval.upper_radps = std::numeric_limits<double>::quiet_NaN();
  if (law.empty()) return interval;
  const double tail = 0.5 * (1.0 - confidence);
  interval.lower_radps = std::sqrt(variance / quantile(law, 1.0 - tail));
  interval.upper_radps = std::sqrt(variance / quantile(law, tail));
  return interval;
}

std::vector<AllanInterval> allan_intervals(const AngleSum& sum, Deviation kind,
                                           std::span<const DeviationPoint> points, const TermVariances& terms,
                                           double confidence) {
  TermVariances noise = terms;
  if (std::ranges::all_of(noise, [](double v) { return v <= 0.0; })) noise[kN] = 1.0;
  std::vector<std::size_t> samples;
  for (const AngleSum::Part& part : sum.parts()) samples.push_back(part.angles - 1);
  std::vector<AllanInterval> intervals;
  for (const DeviationPoint& point : points) {
    const double degrees = point.terms > 0 ? EstimateVariance(kind, point.m, samples).degrees(noise) : 0.0;
    intervals.push_back(
        interval_of(point.variance, estimate_law(kind, point.m, samples, noise, degrees), confidence));
    intervals.back().degrees = degrees;
    double most = 0.0;
    for (std::size_t t = 0; t < kTerms; ++t) {
      const auto term = static_cast<Term>(t);
      const double part = noise[t] * expected_variance(kind, term, point.m);
      if (part > most) intervals.back().strongest = term;
      most = std::max(most, part);
    }
  }
  return intervals;
}

}  // namespace ifog
