// SPDX-License-Identifier: Apache-2.0
// Generalised least squares under known noise, and the maximum likelihood of the noise given regressors. The
// white variance and the regressors' coefficients are concentrated out of the innovations' likelihood.
#pragma once

#include "filters/diagnosis/regression/whitening.h"
#include "filters/linear/normal_equations.h"

namespace ifog {

// Least squares of the first whitened column on the others.
struct WhitenedFit {
  NormalEquations equations;
  double square;               // of the residual
  double blocks, freedom;      // number of valid blocks; minus that of the coefficients
  double innovation_variance;  // / white variance

  [[nodiscard]] Eigen::VectorXd coefficients() const { return equations.coefficients(); }
  [[nodiscard]] Eigen::MatrixXd covariance() const { return square / freedom * equations.inverse(); }
  // Of a block mean, in the first column's unit squared.
  [[nodiscard]] double white_variance() const { return square / freedom / innovation_variance; }
  // Except for a constant that depends only on the number of blocks, or of blocks and coefficients. The
  // determinant of a steady filter cancels the innovations' scale.
  [[nodiscard]] double log_likelihood() const { return -0.5 * blocks * std::log(square / blocks); }
  [[nodiscard]] double restricted_log_likelihood() const {
    return -0.5 * freedom * std::log(square) - 0.5 * equations.log_determinant();
  }
};

// Prior of the last coefficients: zero, with equal variances.
struct Prior {
  Eigen::Index coefficients = 0;
  double weight = 0.0;  // white variance of a block mean / variance of a coefficient
};

// columns: measurement, then regressors, not whitened.
WhitenedFit fit_whitened(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns,
                         const Prior& prior = {});

struct NoiseFit {
  NoiseShape shape;
  double log_likelihood = 0.0;
  double white_variance = 0.0;
};

// Fits walk and flicker, both may become zero, starting at `start`. Keeps the harmonics of `start`.
NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns, const NoiseShape& start,
                   double precision = 1.05);

// Fits from a coarse grid, then the number of harmonics.
NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns);

// Local maximum of the likelihood, starting at `shape`: walk and flicker, if not zero, and the harmonics if
// `with_harmonics`.
NoiseFit climb(const BlockGrid& grid, const Columns& columns, NoiseShape shape, double precision,
               bool with_harmonics = false);

// Resonances and lines in the noise as damped harmonics. Their number minimises the Bayesian information
// criterion. Each is searched where the innovations are not white and is fitted jointly with white noise,
// flicker and walk.

// Limits of harmonics on this grid.
struct HarmonicLimits {
  double least_cycles = 0.0;                   // per block; a slower one could be mistaken for an effect
  double least_decay = 0.0, most_decay = 0.0;  // in blocks; one with a longer decay is a line
};
HarmonicLimits harmonic_limits(const BlockGrid& grid);

// `fit`, which has none, with harmonics, all refitted. columns: measurement, then regressors, not whitened.
NoiseFit with_harmonics(const BlockGrid& grid, const Columns& columns, const NoiseFit& fit);

}  // namespace ifog
