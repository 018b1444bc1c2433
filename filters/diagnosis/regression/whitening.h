// SPDX-License-Identifier: Apache-2.0
// The noise model of block means and its Kalman filter, in steady state: white noise, a random walk,
// flicker as a bank of Gauss-Markov processes of equal variance whose time constants are a factor apart, and
// damped harmonics, which are what a structure that sways and lines that move leave in the rate. That is
// motion, and nothing of it is subtracted; but in a filter that does not know it, it would be white noise,
// and everything else would be judged in that.
//
// The filter turns a series into its innovations. It is linear, so the same filter whitens the measurement
// and every regressor, and ordinary least squares on what comes out is generalised least squares on what went
// in. An unknown constant is a regressor like any other; that is exactly diffuse and needs no start-up case.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "filters/diagnosis/record/blocks.h"
#include "filters/linear/columns.h"

namespace ifog {

// What has the covariance variance exp(-k / decay) cos(2 pi cycles k) at a distance of k blocks, as a resonance
// driven by white noise does.
struct DampedHarmonic {
  // What the harmonic is of. A structure sways in angle, of which a block sees the change: it does not turn away and
  // has no power at slow frequencies. A line inside the sensor is in the rate.
  enum class Of { kAngle, kRate };

  double variance = 0.0;
  double cycles = 0.0;  // a block, at most one half: what is faster is seen at its alias
  double decay = 0.0;   // blocks
  Of of = Of::kAngle;

  // Share of its density at so many cycles a block that a block sees.
  [[nodiscard]] double seen_at(double at_cycles) const {
    const double half_step = std::sin(std::numbers::pi * at_cycles);
    return of == Of::kAngle ? 4.0 * half_step * half_step : 1.0;
  }
  // Variance of what a block sees.
  [[nodiscard]] double seen_variance() const {
    if (of == Of::kRate) return variance;
    return 2.0 * variance * (1.0 - std::exp(-1.0 / decay) * std::cos(2.0 * std::numbers::pi * cycles));
  }
};

// Relative to the white variance of a block mean, which likelihoods concentrate out.
struct NoiseShape {
  double walk = 0.0;     // variance of the random walk's step from block to block
  double flicker = 0.0;  // variance of each process of the bank
  std::vector<DampedHarmonic> harmonics = {};
};

inline constexpr double kFlickerSpacing =
    8.0;  // factor between time constants; ripple of the sum below 0.3 dB

class Whitening {
 public:
  Whitening(const BlockGrid& grid, const NoiseShape& shape);

  // Innovations of every column, in place: restarts at each record, predicts across blocks that are not
  // valid and leaves zero there.
  void apply(Columns& columns) const;

  // Variance of the innovations over the white variance, at least 1.
  [[nodiscard]] double innovation_variance() const { return innovation_variance_; }

 private:
  template <int Width>
  void apply_some(Columns& columns, Eigen::Index first) const;

  // x+ = step x + noise of variance `drive`, seen through `seen`.
  struct StateSpace {
    Eigen::MatrixXd step;
    Eigen::VectorXd drive, seen;
  };
  [[nodiscard]] StateSpace state_space() const;
  void design_gain();

  const BlockGrid& grid_;
  std::vector<double> factor_;  // of the states that only decay: x+ = factor x + gain e
  struct Turn {
    double cosine, sine;  // times what a block leaves of the amplitude
    double before;        // share of x a block ago that a block sees: -1 of an angle, 0 of a rate
  };
  std::vector<Turn> turns_;           // of the harmonics: x, its quadrature, and x a block ago
  std::vector<double> drive_, gain_;  // of all states, in that order
  double innovation_variance_ = 1.0;
};

// What the filter makes of a step at the start of a record of the grid, block by block to its end. A steady
// filter answers a step the same way wherever it is.
Eigen::VectorXd answer_to_step(const BlockGrid& grid, const NoiseShape& shape, const BlockRange& record);

// Time constants of the bank, in blocks.
std::vector<double> flicker_bank(const BlockGrid& grid);

// Power density at so many cycles a block over that of the white noise. Nothing of a walk at zero.
double relative_density(const BlockGrid& grid, const NoiseShape& shape, double cycles);

// The noise in IEEE Std 952 coefficients, of the terms that it has. `white` is the variance of a block mean,
// (rad/s)^2.
NoiseTerms noise_terms(const NoiseShape& shape, double white, double block_s);

}  // namespace ifog
