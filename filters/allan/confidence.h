// SPDX-License-Identifier: Apache-2.0
// Confidence intervals of measured variances, from the distribution of the estimator under the noise of the
// record. The noise is fitted to the whole record, not to the few averages at τ, so its type
// may change along τ.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "filters/allan/deviation.h"
#include "filters/allan/power_law.h"

namespace ifog {

// Distribution of a quadratic form of Gaussian variables: a weighted sum of independent χ². Overlapping
// variances are such sums. With few averages a single χ² of the same mean and variance has too heavy a tail
// near zero: its 68 % interval would hold in 73 to 80 %.
struct WeightedChiSquared {
  double weight = 0.0;   // > 0
  double degrees = 0.0;  // > 0, need not be whole
};

// Quantile of the sum at probability p. One part: exact. Several: saddlepoint approximation (Lugannani and
// Rice, Adv. Appl. Prob. 12, 1980; for quadratic forms Kuonen, Biometrika 86, 1999), whose probability is
// accurate to 2 %.
[[nodiscard]] double quantile(std::span<const WeightedChiSquared> parts, double p);

// Equivalent degrees of freedom, 2·mean²/variance.
[[nodiscard]] double equivalent_degrees(std::span<const WeightedChiSquared> parts);

// Distribution of estimate / mean as a weighted sum of χ². degrees: equivalent degrees of freedom
// (EstimateVariance). If it is large, one χ². Else the weights are eigenvalues of the covariance of
// differences m/8 apart, plus one part for quantisation. samples: lengths of the stretches. Empty if no
// difference fits.
[[nodiscard]] std::vector<WeightedChiSquared> estimate_law(Deviation kind, std::size_t m,
                                                           std::span<const std::size_t> samples,
                                                           const TermVariances& variances, double degrees);

// Covariance matrix of `size` places whose covariance depends on their distance, `variances` of unit terms.
[[nodiscard]] Eigen::MatrixXd toeplitz(std::size_t size,
                                       const std::function<TermVariances(double)>& covariance,
                                       const TermVariances& variances);

// Adds the eigenvalues of a covariance relative to the mean square, except negligible ones.
void add_modes(const Eigen::MatrixXd& covariance, std::vector<WeightedChiSquared>& law);

struct AllanInterval {
  Term strongest = kN;  // largest part of the variance at this τ
  double degrees = 0.0;
  double lower_radps = 0.0, upper_radps = 0.0;  // of the deviation; NaN if no difference fits
};

// Interval that contains the root of the true variance with probability `confidence` (0 to 1). law:
// distribution of estimate / mean.
[[nodiscard]] AllanInterval interval_of(double variance, std::span<const WeightedChiSquared> law,
                                        double confidence);

// One interval per point, for the overlapping estimator `kind` under noise of these terms. White noise is
// assumed if all terms are zero.
[[nodiscard]] std::vector<AllanInterval> allan_intervals(const AngleSum& sum, Deviation kind,
                                                         std::span<const DeviationPoint> points,
                                                         const TermVariances& terms, double confidence);

}  // namespace ifog
