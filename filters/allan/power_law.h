// What the noise terms of IEEE Std 952 do to a difference variance: its mean, and the covariance of estimates
// at different averaging times. Overlapping estimates share most of their data, so neighbouring points of an
// Allan plot are strongly correlated; a fit that takes them for independent promises error bars it does not
// keep.
//
// Everything is in samples: the angle in (rad/s × sample), one sample time = 1.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/deviation.h"

namespace ifog {

inline constexpr std::size_t kTerms = 4;
enum Term : std::size_t { kQ = 0, kN = 1, kB = 2, kK = 3 };

// Variances of the terms, all (rad/s)²: (Q/τ₀)², N²/τ₀, B², K²·τ₀.
using TermVariances = std::array<double, kTerms>;

// Expected variance at m for one unit of a term: Allan 3/m², 1/m, 2 ln 2/π, m/3.
[[nodiscard]] double expected_variance(Deviation kind, Term term, std::size_t m);

// Covariances of the overlapping Allan or Hadamard variances of Gaussian noise at a set of averaging times.
//
// The covariance of two squares is twice the squared covariance of the differences (Isserlis), which follows
// from the generalised covariance of the angle: −|t|/2, t² ln|t|/2π, |t|³/12 for N, B, K and a spike for Q.
// Summed over all pairs of places: exactly near the points where these functions bend, by Gauss–Legendre
// panels that widen away from them. The result is quadratic in the terms' variances, so the sums are made
// once and serve every set of values, every axis and every iteration of a fit.
class DifferenceCovariance {
 public:
  // m ascending. Only kAllan and kHadamard. samples: lengths of the stretches, taken as independent of each
  // other.
  DifferenceCovariance(Deviation kind, std::span<const std::size_t> m, std::span<const std::size_t> samples);

  // Row-major, m.size() squared, (rad/s)⁴.
  [[nodiscard]] std::vector<double> at(const TermVariances& variances) const;
  [[nodiscard]] std::size_t size() const { return count_; }

 private:
  static constexpr std::size_t kPairs = kTerms * (kTerms + 1) / 2;
  std::size_t count_;
  std::vector<std::array<double, kPairs>> sums_;  // upper triangle, row by row
};

}  // namespace ifog
