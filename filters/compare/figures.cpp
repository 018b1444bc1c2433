// SPDX-License-Identifier: Apache-2.0
#include "filters/compare/figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/row_times/median.h"

namespace ifog {

double spread(std::span<const double> values) {
  double mean = 0.0;
  std::size_t n = 0;
  for (const double v : values)
    if (std::isfinite(v)) mean += (v - mean) / static_cast<double>(++n);
  if (n < 2) return 0.0;
  double sum = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(n - 1));
}

namespace {

// Variance of output[k] − reference[k − shift] over the places where both exist, or every stride-th of them
// in a long record: thousands of shifts are tried, and a fraction of the places suffices.
double misfit(std::span<const double> output, std::span<const double> reference, int shift, int margin) {
  double mean = 0.0;
  double sum = 0.0;
  std::size_t n = 0;
  const auto last = static_cast<std::ptrdiff_t>(output.size()) - margin;
  const std::ptrdiff_t stride = std::max<std::ptrdiff_t>(1, (last - margin) / 20000);
  for (std::ptrdiff_t k = margin; k < last; k += stride) {
    const double d = output[static_cast<std::size_t>(k)] - reference[static_cast<std::size_t>(k - shift)];
    if (!std::isfinite(d)) continue;
    const double delta = d - mean;
    mean += delta / static_cast<double>(++n);
    sum += delta * (d - mean);
  }
  return n == 0 ? std::numeric_limits<double>::infinity() : sum / static_cast<double>(n);
}

// Shift with the smallest misfit, in samples; of nearly equal minima (a turntable with a periodic programme)
// the one nearest to zero.
std::optional<double> nearest_dip(const std::vector<double>& at) {
  constexpr double kAsDeep = 0.05;  // of the way from the smallest to the largest
  const double best = *std::ranges::min_element(at);
  const double worst = *std::ranges::max_element(at);
  // A reference at rest fits at any shift, so a contrast of 5 % is required.
  if (worst < 1.05 * best) return std::nullopt;
  const std::ptrdiff_t none = std::ssize(at) / 2;
  std::optional<std::ptrdiff_t> dip;
  for (std::ptrdiff_t i = 0; i < std::ssize(at); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool lowest = (k == 0 || at[k] <= at[k - 1]) && (k + 1 == at.size() || at[k] <= at[k + 1]);
    if (lowest && at[k] <= best + kAsDeep * (worst - best) &&
        (!dip || std::abs(i - none) < std::abs(*dip - none)))
      dip = i;
  }
  if (!dip || *dip == 0 || *dip + 1 == std::ssize(at)) return std::nullopt;
  const auto k = static_cast<std::size_t>(*dip);
  const double curve = at[k - 1] - 2.0 * at[k] + at[k + 1];
  const double fraction = curve > 0.0 ? 0.5 * (at[k - 1] - at[k + 1]) / curve : 0.0;
  return static_cast<double>(*dip - none) + fraction;
}

}  // namespace

AgainstReference against_reference(std::span<const double> output, std::span<const double> reference,
                                   double period_s, int longest_samples) {
  AgainstReference result;
  double square = 0.0;
  double bias = 0.0;
  std::size_t n = 0;
  for (std::size_t k = 0; k < output.size(); ++k) {
    const double d = output[k] - reference[k];
    if (!std::isfinite(d)) continue;
    square += d * d;
    bias += (d - bias) / static_cast<double>(++n);
  }
  if (n == 0) return result;
  result.rmse = std::sqrt(square / static_cast<double>(n));
  result.bias = bias;

  const int longest = std::min(longest_samples, static_cast<int>(output.size() / 4));
  if (longest < 1) return result;
  std::vector<double> at;
  at.reserve(2 * static_cast<std::size_t>(longest) + 1);
  for (int shift = -longest; shift <= longest; ++shift)
    at.push_back(misfit(output, reference, shift, longest));
  const auto lag = nearest_dip(at);
  if (lag) result.lag_s = *lag * period_s;
  return result;
}

HeadingClosure heading_closure(std::span<const double> output, std::span<const double> measured,
                               std::span<const double> dt_s) {
  HeadingClosure result;
  for (std::size_t k = 0; k < output.size(); ++k) {
    const double d = (output[k] - measured[k]) * dt_s[k];
    if (!std::isfinite(d)) continue;
    result.end_rad += d;
    if (std::abs(result.end_rad) > std::abs(result.max_rad)) result.max_rad = result.end_rad;
  }
  return result;
}

Whiteness whiteness(std::span<const double> innovations) {
  constexpr std::size_t kLags = 20;
  double mean = 0.0;
  std::size_t n = 0;
  for (const double v : innovations)
    if (std::isfinite(v)) mean += (v - mean) / static_cast<double>(++n);
  if (n < 2 * kLags) return {};
  double power = 0.0;
  for (const double v : innovations)
    if (std::isfinite(v)) power += (v - mean) * (v - mean);
  Whiteness result;
  if (power <= 0.0) return result;
  double sum = 0.0;
  for (std::size_t lag = 1; lag <= kLags; ++lag) {
    double product = 0.0;
    for (std::size_t k = lag; k < innovations.size(); ++k) {
      const double p = (innovations[k] - mean) * (innovations[k - lag] - mean);
      if (std::isfinite(p)) product += p;
    }
    const double rho = product / power;
    if (lag == 1) result.lag1 = rho;
    sum += rho * rho;
  }
  result.excess = sum * static_cast<double>(n) / static_cast<double>(kLags);
  return result;
}

std::optional<double> median_reached(const std::vector<std::optional<double>>& values) {
  if (values.empty()) return std::nullopt;
  std::vector<double> order;
  for (const auto& v : values) order.push_back(v ? *v : std::numeric_limits<double>::infinity());
  const double middle = median(std::move(order));
  return std::isinf(middle) ? std::nullopt : std::optional(middle);
}

}  // namespace ifog
