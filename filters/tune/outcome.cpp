// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/outcome.h"

#include <algorithm>
#include <cmath>

#include "filters/compare/figures.h"
#include "filters/estimator/estimator.h"

namespace ifog {
namespace {

RateFigures figures_of(std::span<const double> rate, double period_s) {
  return {spread(rate),
          reported_deviations(rate, stretches({}, rate, SampleClock{.period_s = period_s}), period_s)};
}

std::vector<double> ahead_of(std::span<const double> measured, std::span<const double> published) {
  constexpr std::size_t kWindows = 8;
  const std::size_t n = measured.size();
  const auto measurement = std::ranges::find_if(measured, [](double v) { return std::isfinite(v); });
  const double level = measurement == measured.end() ? 0.0 : *measurement;
  std::vector<double> sum(n + 1, 0.0), count(n + 1, 0.0), out;
  for (std::size_t k = 0; k < n; ++k) {
    const bool there = std::isfinite(measured[k]);
    sum[k + 1] = sum[k] + (there ? measured[k] - level : 0.0);
    count[k + 1] = count[k] + (there ? 1.0 : 0.0);
  }
  for (std::size_t m = 1; kWindows * m <= n; m *= 4) {
    double square = 0.0, terms = 0.0;
    for (std::size_t k = 0; k + m < n; ++k) {
      const double in_window = count[k + 1 + m] - count[k + 1];
      if (2.0 * in_window < static_cast<double>(m) || !std::isfinite(published[k])) continue;
      const double miss = (sum[k + 1 + m] - sum[k + 1]) / in_window + level - published[k];
      square += miss * miss;
      terms += 1.0;
    }
    out.push_back(terms > 0.0 ? square / terms : 0.0);
  }
  return out;
}

}  // namespace

Outcome outcome_of(const FilterSettings& settings, std::span<const std::span<const double>> axes,
                   double period_s, std::size_t first) {
  Estimator estimator(settings, static_cast<int>(axes.size()), period_s);
  const std::size_t n = axes[0].size();
  std::vector<std::vector<double>> published(axes.size());
  EstimatorInput in;
  EstimatorOutput out;
  std::size_t last = 0;
  for (std::size_t k = 0; k < n; ++k) {
    in.sequence = k;
    in.valid_axes = 0;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!std::isfinite(axes[a][k])) continue;
      in.rate_radps[a] = axes[a][k];
      in.valid_axes |= 1U << a;
    }
    // Nothing is published without a measurement; the next sample then follows a gap.
    if (in.valid_axes != 0) {
      in.dt_s = k == 0 ? period_s : period_s * static_cast<double>(k - last);
      in.covered_s.fill(period_s);
      estimator.step(in, out);
      last = k;
    }
    if (k < first) continue;
    for (std::size_t a = 0; a < axes.size(); ++a)
      published[a].push_back(in.valid_axes != 0 ? out.denoised_radps[a] : std::nan(""));
  }
  Outcome outcome;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    outcome.before.push_back(figures_of(axes[a].subspan(first), period_s));
    outcome.after.push_back(figures_of(published[a], period_s));
    outcome.ahead.push_back(ahead_of(axes[a].subspan(first), published[a]));
  }
  return outcome;
}

}  // namespace ifog
