// SPDX-License-Identifier: Apache-2.0
// A state model whose noise and parameters are open: the map between what an optimiser moves freely and what
// a filter is given.
//
// Every candidate has a random walk for the level. A gyro's bias is not zero, and a stationary model alone
// would pull the denoised rate towards zero; where the level does not wander its driving noise goes to the
// lower bound. What is added to it is noise: the filter knows it and does not publish it
// (StateModel::rate()).
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
  // "random-walk", then any of gauss-markov, ar(p), and arma(p,q) with q < p, added with " + ". An
  // ARMA(p,q) with q >= p plus white measurement noise is an ARMA(p,q) again, so its R could not be distinguished from
  // the data. Throws std::invalid_argument for another name and for more states than a filter has.
  ModelCandidate(std::string state, double period_s);

  [[nodiscard]] const std::string& state() const { return state_; }  // FilterSettings::state
  [[nodiscard]] int size() const { return size_; }                   // free parameters

  // theta: ln q a sample, ln R, then each term's; dimensionless, for data scaled to unit variance of
  // successive differences.
  void bounds(std::span<double> low, std::span<double> high) const;
  // A start that the spectrum allows, drawn at random.
  [[nodiscard]] std::vector<double> draw(const RecordSpectrum& spectrum, std::mt19937_64& random) const;
  // Expected density at each of the spectrum's bins.
  void density(std::span<const double> theta, const RecordSpectrum& spectrum, std::span<double> out) const;
  // Settings for data in rad/s whose scale (one unit of the normalised data) is `scale`.
  [[nodiscard]] FilterSettings settings(std::span<const double> theta, double scale) const;
  // The same as figures to be reported, each a smooth function of theta.
  [[nodiscard]] std::vector<CandidateFigure> figures(std::span<const double> theta, double scale) const;

 private:
  static constexpr std::size_t kLevel = 2;  // the level's parameters, first in theta
  std::string state_;
  double period_s_;
  std::vector<std::unique_ptr<NoiseTerm>> terms_;
  int size_ = 0;
};

// What `ifog tune` tries when nobody says otherwise.
std::vector<std::string> default_candidates();

}  // namespace ifog
