// SPDX-License-Identifier: Apache-2.0
// Difference variances of noise that is any mixture of the terms of IEEE Std 952: mean, and scatter of an
// estimate. All in samples: the angle in (rad/s × sample), one sample time = 1.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "filters/allan/deviation.h"

namespace ifog {

inline constexpr std::size_t kTerms = 4;
enum Term : std::size_t { kQ = 0, kN = 1, kB = 2, kK = 3 };

// Variances of the terms in (rad/s)²: (Q/τ₀)², N²/τ₀, B², K²·τ₀. Averages over L samples have the same terms
// with variances divided by L², by L, unchanged, times L.
using TermVariances = std::array<double, kTerms>;

// Generalised covariance of the angle at lag t for one unit of each term: spike, −|t|/2, t² ln|t|/2π,
// |t|³/12. It omits polynomials, which a second difference cancels. The spike is at t == 0 exactly.
[[nodiscard]] std::array<double, kTerms> covariance_of_angle(double t);

// Covariance of the differences of `kind` at places `lag` samples apart, not normalised, for one unit of each
// term. For kModified lag must be whole or far from zero.
[[nodiscard]] std::array<double, kTerms> covariance_of_differences(Deviation kind, std::size_t m, double lag);

// The same for second differences of the angle's running sum.
[[nodiscard]] TermVariances covariance_of_sum_differences(std::size_t m, double lag);

// Expected variance at m for one unit of a term; Allan: 3/m², 1/m, 2 ln 2/π, m/3.
[[nodiscard]] double expected_variance(Deviation kind, Term term, std::size_t m);
[[nodiscard]] double expected_variance(Deviation kind, const TermVariances& variances, std::size_t m);

// Variance of the overlapping estimate at one averaging time, for Gaussian noise: twice the mean, over all
// pairs of places, of the squared covariance of their differences (Isserlis). Greenhall and Riley (35th PTTI,
// 2003) sum this for one power law; here the covariance is that of a sum of terms.
//
// The sum is exact where the covariance bends and uses Gauss–Legendre rules elsewhere. The result is quadratic in the
// terms' variances, so the sums are computed once for all sets of variances.
class EstimateVariance {
 public:
  // samples: lengths of the stretches, assumed independent. Stretches too short for the difference are
  // ignored.
  EstimateVariance(Deviation kind, std::size_t m, std::span<const std::size_t> samples);

  [[nodiscard]] double at(const TermVariances& variances) const;  // (rad/s)⁴
  // Equivalent degrees of freedom, 2·mean²/variance; 0 if no difference fits.
  [[nodiscard]] double degrees(const TermVariances& variances) const;

 private:
  Deviation kind_;
  std::size_t m_;
  Eigen::Matrix4d sums_ = Eigen::Matrix4d::Zero();
};

}  // namespace ifog
