// SPDX-License-Identifier: Apache-2.0
// State model with free noise and parameters, and the map between the optimiser's variables and filter
// settings.
//
// Every candidate has a random walk for the level, since a stationary model alone would pull the denoised
// rate towards zero. If the level does not wander, its driving noise becomes the lower bound. Added terms are
// noise, which the filter models but does not publish (StateModel::rate()).
#pragma once

#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "filters/settings/filter_settings.h"
#include "filters/tune/noise_term.h"

namespace ifog {

class ModelCandidate {
 public:
  // state: "random-walk", optionally with gauss-markov, ar(p) and arma(p,q) with q < p, added with " + ". (An
  // ARMA(p,q) with q >= p plus white noise is an ARMA(p,q), so R would not be identifiable.) Throws
  // std::invalid_argument for another name or too many states.
  ModelCandidate(std::string state, double period_s);

  [[nodiscard]] const std::string& state() const { return state_; }  // FilterSettings::state
  [[nodiscard]] int size() const { return size_; }                   // number of free parameters

  // theta: ln q per sample, ln R, then each term's parameters; dimensionless, for data with unit variance of
  // successive differences.
  void bounds(std::span<double> low, std::span<double> high) const;
  // Random start value compatible with the spectrum.
  [[nodiscard]] std::vector<double> draw(const RecordSpectrum& spectrum, std::mt19937_64& random) const;
  // Expected density at each bin of the spectrum.
  void density(std::span<const double> theta, const RecordSpectrum& spectrum, std::span<double> out) const;
  // Settings for data in rad/s. scale: unit of the normalised data.
  [[nodiscard]] FilterSettings settings(std::span<const double> theta, double scale) const;
  // The same as figures for the report, each a smooth function of theta.
  [[nodiscard]] std::vector<CandidateFigure> figures(std::span<const double> theta, double scale) const;

 private:
  static constexpr std::size_t kLevel = 2;  // number of the level's parameters, first in theta
  template <typename T, typename Use>
  void for_each_term(std::span<T> theta, Use use) const;

  std::string state_;
  double period_s_;
  std::vector<std::unique_ptr<NoiseTerm>> terms_;
  int size_ = 0;
};

// Default models of `ifog tune`.
std::vector<std::string> default_candidates();

}  // namespace ifog
