// SPDX-License-Identifier: Apache-2.0
// The five noise coefficients of IEEE Std 952 of one record at rest, each with its error bar:
//   σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2.
//
// Q, N, B and K are maximum-likelihood estimates from the spectrum (noise_spectrum.h). A rate ramp is
// projected out, so it cannot be confused with a random walk. A term is present if the fit is clearly worse
// without it. R is the ramp by generalised least squares.
//
// `ifog allan`, `tune` and `diagnose` all use this function.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "filters/allan/noise/gauss_markov.h"
#include "filters/allan/noise/noise_spectrum.h"

namespace ifog {

struct NoiseCoefficient {
  bool present = false;
  double value = 0.0;      // SI, as in the formula above; 0 when absent
  double std_error = 0.0;  // one standard deviation; of an absent term upper/1.96
  double upper = 0.0;      // 97.5 % upper limit; also valid if the term is not detected
  // Of a present term: shortest averaging time at which it is below the measured curve (a filter suppresses
  // it below that); 0 if it is below everywhere.
  double from_s = 0.0;
};

// First-order Gauss-Markov bias (gauss_markov.h), if the record shows one.
struct MarkovNoise {
  bool present = false;        // else it is used only in forecasts and not reported
  double sigma_radps = 0.0;    // of the bias
  double correlation_s = 0.0;  // with its 95 % interval
  double lower_s = 0.0, upper_s = 0.0;
  double walk = 0.0;                       // K of the equivalent random walk at short τ, rad/s²/√Hz
  double walk_until_s = 0.0;               // up to this τ the random walk's deviation is within 10 %
  std::vector<GaussMarkovChance> chances;  // possible values; for averages at these samples
  GaussMarkovFit fit;
};

struct NoiseCoefficients {
  NoiseCoefficient Q, N, B, K, R;  // rad, rad/s/√Hz, rad/s, rad/s²/√Hz, rad/s²
  double ramp_radps2 = 0.0;        // R with its sign
  // Relative difference between the measured deviation and the sum of terms beyond chance; 0 if the terms
  // describe the record. Included in the error bars, except for what a correlated bias causes at long τ.
  double misfit = 0.0;
  // Largest relative difference of the terms' from the measured Allan deviation, and its τ; 0: within chance. The
  // error bar of the strongest term there reaches the curve (curve_miss.h).
  struct CurveMiss {
    double departure = 0.0, tau_s = 0.0;
  } curve;
  std::optional<MarkovNoise> markov;        // set if K does not hold at long τ
  std::vector<FrequencyRange> lines_hz;     // spectral lines
  std::vector<FrequencyRange> left_out_hz;  // no sum of the terms fits here: resonances, vibration, filters
  // Most likely variances, also of terms that are not present; for averages at these samples.
  TermVariances variances{};
};

// Throws std::invalid_argument with a message if the longest stretch has fewer than 64 samples or the rate
// never changes.
[[nodiscard]] NoiseCoefficients noise_coefficients(const AngleSum& sum, double period_s);

// Allan variance at τ by term, (rad/s)².
struct NoiseShare {
  NoiseCoefficient NoiseCoefficients::*term;
  double variance;
};
[[nodiscard]] std::array<NoiseShare, 5> shares_at(const NoiseCoefficients& found, double tau_s);

// Allan deviation at τ of the present terms, rad/s.
[[nodiscard]] double modelled_deviation(const NoiseCoefficients& found, double tau_s);

// "the bias is correlated: …", or "" if it is not.
[[nodiscard]] std::string markov_in_words(const NoiseCoefficients& found);

}  // namespace ifog
