// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/estimate_law.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

// Above, a single χ² is accurate to half a per cent of probability.
constexpr double kFew = 30.0;
constexpr std::size_t kPlacesAnAverage = 8;

// Adds eigenvalues of the covariance of `places` differences `step` samples apart, relative to their mean
// square.
void add_modes(Deviation kind, std::size_t m, std::size_t places, std::size_t step,
               const TermVariances& variances, double share, std::vector<WeightedChiSquared>& law) {
  const auto n = static_cast<Eigen::Index>(places);
  Eigen::VectorXd lag(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const TermVariances one =
        covariance_of_differences(kind, m, static_cast<double>(i) * static_cast<double>(step));
    lag[i] = std::inner_product(one.begin(), one.end(), variances.begin(), 0.0);
  }
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) = lag[std::abs(i - j)];
  covariance *= share / static_cast<double>(places);
  const Eigen::VectorXd weights = symmetric_eigenvalues(covariance);
  const double least = 1e-6 * weights.maxCoeff();
  for (const double weight : weights)
    if (weight > least) law.push_back({weight, 1.0});
}

}  // namespace

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

  std::vector<double> places;
  for (const std::size_t n : samples)
    if (const std::size_t reach = differences_of(kind, m, n); reach > 0)
      places.push_back(static_cast<double>(reach));
  const double all = std::accumulate(places.begin(), places.end(), 0.0);
  const std::size_t step = std::max<std::size_t>(1, m / kPlacesAnAverage);
  std::vector<WeightedChiSquared> law;
  for (const double p : places)
    add_modes(kind, m, (static_cast<std::size_t>(p) - 1) / step + 1, step, slow,
              slow_share / slow_square * p / all, law);
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

}  // namespace ifog
