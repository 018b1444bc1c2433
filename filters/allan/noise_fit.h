// The five noise coefficients of IEEE Std 952 from one record at rest, each with its error bar, and none that
// the record does not show:
//   σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2.
//
// Q, N, B and K come from the overlapping Hadamard variance at octaves of τ by generalised least squares,
// with the exact covariance of the estimates under the fitted terms (power_law.h), iterated until both agree.
// The Hadamard variance follows the same terms as the Allan variance but does not see a ramp, so that a ramp
// and a rate random walk, alike on an Allan plot, cannot take each other's part. R is then the ramp itself:
// the difference of the record's two halves against what the other four make of it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "filters/allan/deviation.h"
#include "filters/allan/power_law.h"

namespace ifog {

struct NoiseCoefficient {
  bool present = false;
  double value = 0.0;      // SI, as in the formula above; 0 when absent
  double std_error = 0.0;  // one standard deviation; of an absent term: what it could be and stay unseen
  double score = 0.0;      // how many standard deviations it stands out of the fit without it
};

struct NoiseFit {
  NoiseCoefficient Q, N, B, K, R;  // rad, rad/s/√Hz, rad/s, rad/s²/√Hz, rad/s²
  double ramp_radps2 = 0.0;        // R with its sign
  // Relative departure of the measured deviation from the sum of terms that chance does not explain; 0 when
  // the terms describe the record. It is part of the error bars.
  double misfit = 0.0;
  double longest_tau_s = 0.0;          // of the averages the fit rests on
  std::vector<double> left_out_tau_s;  // averages that no sum of the terms comes near: lines, vibration
};

// Throws std::invalid_argument in words for people: fewer than 64 samples in the longest stretch, or a rate
// that never changes.
[[nodiscard]] NoiseFit fit_noise(const AngleSum& sum, double period_s, unsigned threads = 0);

// Allan deviation at τ of the terms that are present, rad/s.
[[nodiscard]] double modelled_deviation(const NoiseFit& fit, double tau_s);

}  // namespace ifog
