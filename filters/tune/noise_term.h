// SPDX-License-Identifier: Apache-2.0
// Noise process with free parameters that a candidate adds to the level's random walk.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "filters/tune/spectrum.h"

namespace ifog {

// Reported figure of a noise term.
struct CandidateFigure {
  std::string name, unit;
  double value = 0.0;
};

class NoiseTerm {
 public:
  virtual ~NoiseTerm() = default;
  [[nodiscard]] virtual int size() const = 0;  // number of free parameters; the first is ln of a variance
  virtual void bounds(std::span<double> low, std::span<double> high) const = 0;
  // Adds the expected density at each bin of the spectrum.
  virtual void add_density(std::span<const double> theta, const RecordSpectrum& spectrum,
                           std::span<double> out) const = 0;
  // FilterSettings::state_parameters of the term for unit scale; the last is its driving noise per second.
  [[nodiscard]] virtual std::vector<double> parameters(std::span<const double> theta,
                                                       double period_s) const = 0;
  [[nodiscard]] virtual std::vector<CandidateFigure> figures(std::span<const double> theta, double scale,
                                                             double period_s) const = 0;
};

// "gauss-markov", "ar(p)", "arma(p,q)" with q < p <= 6. Null for another name.
std::unique_ptr<NoiseTerm> make_noise_term(const std::string& name);

// Coefficients of a stationary AR(p) from partial autocorrelations in (−1, 1), by the Durbin-Levinson
// recursion (Barndorff-Nielsen and Schou, J. Multivariate Analysis 3, 1973).
std::vector<double> ar_from_partial(std::span<const double> partial);

}  // namespace ifog
