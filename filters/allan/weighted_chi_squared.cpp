// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/weighted_chi_squared.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/distributions/chi_squared.h"

namespace ifog {
namespace {

// Cumulant generating function ln E exp(sX) and its derivatives, for s < 1 / (2·largest weight).
struct Generating {
  double value = 0.0, first = 0.0, second = 0.0, third = 0.0;
};

Generating generating(std::span<const WeightedChiSquared> parts, double s) {
  Generating k;
  for (const WeightedChiSquared& part : parts) {
    const double left = 1.0 - 2.0 * part.weight * s, a = part.weight / left;
    k.value -= 0.5 * part.degrees * std::log(left);
    k.first += part.degrees * a;
    k.second += 2.0 * part.degrees * a * a;
    k.third += 8.0 * part.degrees * a * a * a;
  }
  return k;
}

// Probability of values below the one whose saddlepoint is s.
double probability(const Generating& k, double s) {
  const double density = 1.0 / std::sqrt(2.0 * std::numbers::pi);
  const double w = std::copysign(std::sqrt(std::max(0.0, 2.0 * (s * k.first - k.value))), s);
  const double skew = k.third / std::pow(k.second, 1.5);
  // At the mean both correction terms diverge but their difference is finite.
  if (std::abs(w) < 1e-4) return 0.5 + density * (w + skew / 6.0);
  const double u = s * std::sqrt(k.second);
  return 0.5 * std::erfc(-w / std::numbers::sqrt2) + density * std::exp(-0.5 * w * w) * (1.0 / w - 1.0 / u);
}

}  // namespace

double quantile(std::span<const WeightedChiSquared> parts, double p) {
  if (parts.size() == 1) return parts[0].weight * chi_squared_quantile(p, parts[0].degrees);
  double largest = 0.0;
  for (const WeightedChiSquared& part : parts) largest = std::max(largest, part.weight);
  // 1 − 2·largest·s = exp(−y) maps all valid s to all y.
  double low = -60.0, high = 60.0, value = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double y = 0.5 * (low + high), s = -0.5 * std::expm1(-y) / largest;
    const Generating k = generating(parts, s);
    value = k.first;
    (probability(k, s) < p ? low : high) = y;
  }
  return value;
}

double equivalent_degrees(std::span<const WeightedChiSquared> parts) {
  double mean = 0.0, square = 0.0;
  for (const WeightedChiSquared& part : parts) {
    mean += part.weight * part.degrees;
    square += part.weight * part.weight * part.degrees;
  }
  return square > 0.0 ? mean * mean / square : 0.0;
}

}  // namespace ifog
