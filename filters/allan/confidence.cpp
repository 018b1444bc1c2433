// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/confidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "filters/distributions/chi_squared.h"
#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

// Above, a single χ² is accurate to half a per cent of probability.
constexpr double kFew = 30.0;
constexpr std::size_t kPlacesAnAverage = 8;

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

Eigen::MatrixXd toeplitz(std::size_t size, const std::function<TermVariances(double)>& covariance,
                         const TermVariances& variances) {
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::VectorXd lag(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const TermVariances one = covariance(static_cast<double>(i));
    lag[i] = std::inner_product(one.begin(), one.end(), variances.begin(), 0.0);
  }
  return Eigen::MatrixXd::NullaryExpr(n, n,
                                      [&](Eigen::Index i, Eigen::Index j) { return lag[std::abs(i - j)]; });
}

void add_modes(const Eigen::MatrixXd& covariance, std::vector<WeightedChiSquared>& law) {
  const Eigen::VectorXd weights = symmetric_eigenvalues(covariance);
  const double least = 1e-6 * weights.maxCoeff();
  for (const double weight : weights)
    if (weight > least) law.push_back({weight, 1.0});
}

std::vector<WeightedChiSquared> estimate_law(Deviation kind, std::size_t m,
                                             std::span<const std::size_t> samples,
                                             const TermVariances& variances, double degrees) {
  if (!(degrees > 0.0)) return {};
  const WeightedChiSquared single{1.0 / degrees, degrees};
  if (degrees > kFew) return {single};
  TermVariances slow = variances;
  // The modified deviation averages quantisation over neighbours before it squares.
  if (kind != Deviation::kModified) slow[kQ] = 0.0;
  const double mean = expected_variance(kind, variances, m);
  const double slow_share = expected_variance(kind, slow, m) / mean;
  if (slow_share < 1e-6) return {single};
  const TermVariances at_zero = covariance_of_differences(kind, m, 0.0);
  const double slow_square = std::inner_product(at_zero.begin(), at_zero.end(), slow.begin(), 0.0);

  std::vector<std::size_t> places;
  for (const std::size_t n : samples)
    if (const std::size_t fit = differences_of(kind, m, n); fit > 0) places.push_back(fit);
  const std::size_t all = std::reduce(places.begin(), places.end());
  const std::size_t step = std::max<std::size_t>(1, m / kPlacesAnAverage);
  std::vector<WeightedChiSquared> law;
  const auto of_places = [&](double apart) {
    return covariance_of_differences(kind, m, apart * static_cast<double>(step));
  };
  for (const std::size_t p : places) {
    const std::size_t used = (p - 1) / step + 1;
    const double share = static_cast<double>(p) / static_cast<double>(all * used);
    add_modes(slow_share / slow_square * share * toeplitz(used, of_places, slow), law);
  }
  double square = 0.0;
  for (const WeightedChiSquared& part : law) square += part.weight * part.weight;
  // Quantisation scatters less than the whole, hardly at all with many averages. The rest of the squares'
  // difference comes from the steps between the places.
  const double rest = 1.0 - slow_share;
  const double rest_square =
      std::clamp(1.0 / degrees - square, 1e-6 * rest * rest, std::max(0.5 / degrees, 1e-6 * rest) * rest);
  if (rest > 1e-6) law.push_back({rest_square / rest, rest * rest / rest_square});
  return law;
}

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
  constexpr std::array kPowerLaws = {kQ, kN, kB, kK};
  for (const DeviationPoint& point : points) {
    const double degrees = point.terms > 0 ? EstimateVariance(kind, point.m, samples).degrees(noise) : 0.0;
    intervals.push_back(
        interval_of(point.variance, estimate_law(kind, point.m, samples, noise, degrees), confidence));
    intervals.back().degrees = degrees;
    intervals.back().strongest = *std::ranges::max_element(
        kPowerLaws, {}, [&](Term term) { return noise[term] * expected_variance(kind, term, point.m); });
  }
  return intervals;
}

}  // namespace ifog
