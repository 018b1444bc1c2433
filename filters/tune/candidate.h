// A state model whose noise and parameters are open: the map between what an optimiser moves freely and what
// a filter is told.
//
// Every candidate has a random walk for the level. A gyro's bias is not zero, and a stationary model alone
// would pull the denoised rate towards zero; where the level does not wander its driving noise goes to the
// lower bound.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "filters/settings/filter_settings.h"

namespace ifog {

// What a filter is told, with the name and unit of each figure.
struct CandidateFigure {
  std::string name, unit;
  double value = 0.0;
};

class Candidate {
 public:
  virtual ~Candidate() = default;
  [[nodiscard]] virtual std::string state() const = 0;  // FilterSettings::state
  [[nodiscard]] virtual int size() const = 0;           // free parameters
  // Where to start and how far to go; theta is dimensionless, data scaled to unit variance of successive
  // differences.
  virtual void start(std::span<double> theta) const = 0;
  virtual void bounds(std::span<double> low, std::span<double> high) const = 0;
  // Settings for data in rad/s whose scale (one unit of the normalised data) is `scale`.
  [[nodiscard]] virtual FilterSettings settings(std::span<const double> theta, double scale) const = 0;
  // The same as figures to be reported, each a smooth function of theta.
  [[nodiscard]] virtual std::vector<CandidateFigure> figures(std::span<const double> theta,
                                                             double scale) const = 0;
};

// "random-walk", "random-walk + gauss-markov", "random-walk + ar(p)", "random-walk + arma(p,q)" with q < p.
// An ARMA(p,q) with q >= p plus white measurement noise is an ARMA(p,q) again, so its R could not be told
// from the data. Throws std::invalid_argument for another name.
std::unique_ptr<Candidate> make_candidate(const std::string& state, double period_s);

// What `ifog tune` tries when nobody says otherwise.
std::vector<std::string> default_candidates();

// Coefficients of a stationary AR(p) from partial autocorrelations in (−1, 1): Durbin and Levinson's
// recursion, as Barndorff-Nielsen and Schou use it (J. Multivariate Analysis 3, 1973).
std::vector<double> ar_from_partial(std::span<const double> partial);

}  // namespace ifog
