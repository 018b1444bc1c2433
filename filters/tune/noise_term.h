// SPDX-License-Identifier: Apache-2.0
// What a candidate adds to the wandering level: one process whose parameters are open.
#pragma once

#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "filters/tune/spectrum.h"

namespace ifog {

// A term of the noise that a filter is given, with the name and unit of each figure.
struct CandidateFigure {
  std::string name, unit;
  double value = 0.0;
};

class NoiseTerm {
 public:
  virtual ~NoiseTerm() = default;
  [[nodiscard]] virtual int size() const = 0;  // free parameters; the first is ln of a variance
  virtual void bounds(std::span<double> low, std::span<double> high) const = 0;
  // A shape drawn at random, where the spectrum suggests one; leaves the first parameter alone.
  virtual void draw_shape(const RecordSpectrum& spectrum, std::mt19937_64& random,
                          std::span<double> theta) const = 0;
  // Adds the expected density at each of the spectrum's bins.
  virtual void add_density(std::span<const double> theta, const RecordSpectrum& spectrum,
                           std::span<double> out) const = 0;
  // FilterSettings::state_parameters of the term for unit scale, its driving noise last, per second.
  [[nodiscard]] virtual std::vector<double> parameters(std::span<const double> theta,
                                                       double period_s) const = 0;
  [[nodiscard]] virtual std::vector<CandidateFigure> figures(std::span<const double> theta, double scale,
                                                             double period_s) const = 0;
};

// "gauss-markov", "ar(p)", "arma(p,q)" with q < p <= 6. Nothing for another name.
std::unique_ptr<NoiseTerm> make_noise_term(const std::string& name);

// Coefficients of a stationary AR(p) from partial autocorrelations in (−1, 1): Durbin and Levinson's
// recursion, as Barndorff-Nielsen and Schou use it (J. Multivariate Analysis 3, 1973). And back.
std::vector<double> ar_from_partial(std::span<const double> partial);
std::vector<double> partial_from_ar(std::vector<double> phi);

}  // namespace ifog
