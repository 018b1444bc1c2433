// SPDX-License-Identifier: Apache-2.0
// The five noise coefficients of IEEE Std 952 from one record at rest, each with its error bar, and none that
// the record does not show:
//   σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2.
//
// Q, N, B and K by maximum likelihood over the record's spectrum (noise_spectrum.h), with a rate ramp
// projected out, so that a ramp and a random walk, alike on an Allan plot, cannot take each other's part. A
// term is present if the record cannot be described nearly as well without it, whatever the other terms then
// do. R is the ramp itself, by generalised least squares.
//
// This is the one place where the project says what N, B and K of a record are: `ifog allan`, `tune` and
// `diagnose` all report what it finds.
#pragma once

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
  double upper = 0.0;      // above the truth in 97.5 % of records, those included where the term stays unseen
  double score = 0.0;      // how many standard deviations the record asks for it
  // For a term that is present: below this averaging time it would be more than the whole curve, which a filter
  // holds down there; 0 where it is within the curve all along.
  double from_s = 0.0;
};

// A bias that wanders and comes back (gauss_markov.h), where the record shows that it does.
struct MarkovNoise {
  bool present = false;        // else only forecasts weigh it, and it is not reported
  double sigma_radps = 0.0;    // of the bias
  double correlation_s = 0.0;  // and how long it remembers, with its 95 % interval
  double lower_s = 0.0, upper_s = 0.0;
  double walk = 0.0;                       // K of the walk that it is at short times, rad/s²/√Hz
  double walk_until_s = 0.0;               // up to here the walk's deviation is its own within a tenth
  double score = 0.0;                      // how many standard deviations the record asks for the return
  std::vector<GaussMarkovChance> chances;  // what the record allows it to be; for averages at these samples
  GaussMarkovFit fit;                      // likewise
};

struct NoiseCoefficients {
  NoiseCoefficient Q, N, B, K, R;  // rad, rad/s/√Hz, rad/s, rad/s²/√Hz, rad/s²
  double ramp_radps2 = 0.0;        // R with its sign
  // Relative departure of the measured deviation from the sum of terms that chance does not explain; 0 when
  // the terms describe the record. It is part of the error bars, but for what a correlated bias departs by at
  // long τ.
  double misfit = 0.0;
  std::optional<MarkovNoise> markov;     // where K is no law of long τ
  std::vector<FrequencyRange> lines_hz;  // stood out of the spectrum
  std::vector<FrequencyRange>
      left_out_hz;  // where no sum of the terms comes near: resonances, vibration, filters
  // The likeliest variances, of terms too uncertain to be called present too; for averages at these samples.
  TermVariances variances{};
};

// Throws std::invalid_argument in words for people: fewer than 64 samples in the longest stretch, or a rate
// that never changes.
[[nodiscard]] NoiseCoefficients noise_coefficients(const AngleSum& sum, double period_s);

// Allan deviation at τ of the terms that are present, rad/s.
[[nodiscard]] double modelled_deviation(const NoiseCoefficients& found, double tau_s);

// "the bias is correlated: …", "": it is not.
[[nodiscard]] std::string markov_in_words(const NoiseCoefficients& found);

}  // namespace ifog
