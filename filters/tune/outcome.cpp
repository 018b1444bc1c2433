// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/outcome.h"

#include <algorithm>
#include <cmath>

#include "filters/allan/deviation.h"
#include "filters/estimator/estimator.h"

namespace ifog {
namespace {

// One thread: the caller has its own.

RateFigures figures_of(std::span<const double> rate, double period_s) {
  RateFigures out;
  double count = 0.0, mean = 0.0, square = 0.0;
  for (const double v : rate) {
    if (!std::isfinite(v)) continue;
    count += 1.0;
    const double difference = v - mean;
    mean += difference / count;
    square += difference * (v - mean);
  }
  out.rms_radps = count > 0.0 ? std::sqrt(square / count) : 0.0;
  const std::vector<Stretch> all = stretches({}, rate, SampleClock{.period_s = period_s});
  if (all.empty()) return out;
  const AngleSum sum(rate, all);
  for (std::size_t t = 0; t < kOutcomeTaus.size(); ++t) {
    const double samples = std::round(kOutcomeTaus[t] / period_s);
    if (samples < 1.0 || 3.0 * samples > static_cast<double>(rate.size())) continue;
    const std::array<std::size_t, 1> m{static_cast<std::size_t>(samples)};
    const DeviationPoint point = deviation(sum, m, Deviation::kAllan)[0];
    if (point.terms > 0) out.adev_radps[t] = std::sqrt(point.variance);
  }
  return out;
}

}  // namespace

Outcome::Ratios Outcome::against(const Outcome& other) const {
  Ratios ratios;
  double sum = 0.0, count = 0.0;
  const auto take = [&](double mine, double others) {
    if (!(mine > 0.0 && others > 0.0)) return;
    ratios.largest = std::max(ratios.largest, mine / others);
    sum += std::log(mine / others);
    count += 1.0;
  };
  for (std::size_t a = 0; a < after.size(); ++a) {
    take(after[a].rms_radps, other.after[a].rms_radps);
    for (std::size_t t = 0; t < kOutcomeTaus.size(); ++t)
      if (after[a].adev_radps[t] && other.after[a].adev_radps[t])
        take(*after[a].adev_radps[t], *other.after[a].adev_radps[t]);
  }
  if (count > 0.0) ratios.mean = std::exp(sum / count);
  return ratios;
}

Outcome outcome_of(const FilterSettings& settings, std::span<const std::span<const double>> axes,
                   double period_s, std::size_t first) {
  Estimator estimator(settings, static_cast<int>(axes.size()), period_s);
  const std::size_t n = axes[0].size();
  std::vector<std::vector<double>> published(axes.size());
  EstimatorInput in;
  EstimatorOutput out;
  in.dt_s = period_s;
  for (std::size_t k = 0; k < n; ++k) {
    in.sequence = k;
    in.valid_axes = 0;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!std::isfinite(axes[a][k])) continue;
      in.rate_radps[a] = axes[a][k];
      in.valid_axes |= 1U << a;
    }
    estimator.step(in, out);
    if (k < first) continue;
    for (std::size_t a = 0; a < axes.size(); ++a) published[a].push_back(out.denoised_radps[a]);
  }
  Outcome outcome;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    outcome.before.push_back(figures_of(axes[a].subspan(first), period_s));
    outcome.after.push_back(figures_of(published[a], period_s));
  }
  return outcome;
}

}  // namespace ifog
