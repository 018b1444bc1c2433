// SPDX-License-Identifier: Apache-2.0
// Noise model of block means and its steady-state Kalman filter: white noise, random walk, flicker as a bank
// of Gauss-Markov processes of equal variance, and damped harmonics for swaying structures and moving lines.
// Harmonics are motion and are not subtracted. Without them in the model they would count as white noise and
// hide everything else.
//
// The filter is linear: it whitens the measurement and every regressor alike, and least squares on the
// innovations is generalised least squares. An unknown constant is a regressor too, so no start-up case is
// needed.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "filters/diagnosis/record/blocks.h"
#include "filters/linear/columns.h"

namespace ifog {

// Process with covariance variance exp(-k / decay) cos(2 pi cycles k) at a lag of k blocks, e.g. a resonance
// driven by white noise.
struct DampedHarmonic {
  // Quantity of the harmonic. A structure sways in angle; a block sees its change, which has no power at low
  // frequencies. A line inside the sensor is in the rate.
  enum class Of { kAngle, kRate };

  double variance = 0.0;
  double cycles = 0.0;  // per block, at most 0.5; faster ones appear at their alias
  double decay = 0.0;   // in blocks
  Of of = Of::kAngle;

  // Factor of its density at `at_cycles` per block, as seen in the block means.
  [[nodiscard]] double seen_at(double at_cycles) const {
    const double half_step = std::sin(std::numbers::pi * at_cycles);
    return of == Of::kAngle ? 4.0 * half_step * half_step : 1.0;
  }
  // Variance in the block means.
  [[nodiscard]] double seen_variance() const {
    if (of == Of::kRate) return variance;
    return 2.0 * variance * (1.0 - std::exp(-1.0 / decay) * std::cos(2.0 * std::numbers::pi * cycles));
  }
};

// Relative to the white variance of a block mean, which is concentrated out.
struct NoiseShape {
  double walk = 0.0;     // of the random walk's step per block
  double flicker = 0.0;  // of each process of the bank
  std::vector<DampedHarmonic> harmonics = {};
};

inline constexpr double kFlickerSpacing = 8.0;  // ratio of time constants; ripple of the sum below 0.3 dB

class Whitening {
 public:
  Whitening(const BlockGrid& grid, const NoiseShape& shape);

  // Replaces each column by its innovations: restarts at each record, predicts across blocks that are not
  // valid and sets zero there.
  void apply(Columns& columns) const;

  // Variance of the innovations / white variance, at least 1.
  [[nodiscard]] double innovation_variance() const { return innovation_variance_; }

 private:
  template <int Width>
  void apply_some(Columns& columns, Eigen::Index first) const;

  // x+ = step x + noise of variance `drive`, observed through `seen`.
  struct StateSpace {
    Eigen::MatrixXd step;
    Eigen::VectorXd drive, seen;
  };
  [[nodiscard]] StateSpace state_space() const;
  void design_gain();

  const BlockGrid& grid_;
  std::vector<double> factor_;  // of the states that only decay: x+ = factor x + gain e
  struct Turn {
    double cosine, sine;  // times the decay per block
    double before;        // factor of the previous x in the observation: -1 for an angle, 0 for a rate
  };
  std::vector<Turn> turns_;           // of the harmonics: x, its quadrature, and the previous x
  std::vector<double> drive_, gain_;  // of all states, in this order
  double innovation_variance_ = 1.0;
};

// Filter's response to a step at the start of a record, by block. A steady-state filter has the same response
// anywhere.
Eigen::VectorXd answer_to_step(const BlockGrid& grid, const NoiseShape& shape, const BlockRange& record);

// Time constants of the bank, in blocks.
std::vector<double> flicker_bank(const BlockGrid& grid);

// Power density at `cycles` per block / that of the white noise; without the walk at zero.
double relative_density(const BlockGrid& grid, const NoiseShape& shape, double cycles);

// Noise as coefficients of IEEE Std 952. white: variance of a block mean, (rad/s)^2.
NoiseTerms noise_terms(const NoiseShape& shape, double white, double block_s);

}  // namespace ifog
