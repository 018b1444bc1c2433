// SPDX-License-Identifier: Apache-2.0
// The model of the rate between samples: x(k+1) = A x(k) + w, rate = h'x, with A and cov w as
// functions of the time between samples. Axes of one sensor share one model.
//
// Names and parameters (FilterSettings::state, ::state_parameters), q = process_noise in (rad/s)^2/s:
//   random-walk                    -            driven by q
//   integrated-random-walk         -            the slope is driven by q, then in (rad/s^2)^2/s
//   gauss-markov      correlation time s        driven by q; stationary variance q tau / 2
//   ar(p)             phi_1 … phi_p             y_k = sum phi_i y_{k-i} + e_k, var e = q * nominal period
//   arma(p,q)         phi_1 … phi_p, theta_1 …  y_k = sum phi_i y_{k-i} + e_k + sum theta_i e_{k-i}
//   harmonic          frequency Hz              two quadrature states, each driven by q
// Sums are written with " + ". Each term after the first takes one more parameter, after its own: the ratio
// of its driving noise to q. "random-walk + harmonic" with {4.17, 0.1}: a line at 4.17 Hz whose states are
// driven by 0.1 q.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ifog {

inline constexpr int kMaxStates = 8;

// Column-major n x n, written into the fixed-size matrices of the filter; the caller's memory, so nothing
// allocates.
using StateMatrixRef = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

class StateModel {
 public:
  virtual ~StateModel() = default;

  [[nodiscard]] virtual int states() const noexcept = 0;
  // Transition over dt seconds and covariance of the driving noise gathered in them, for unit q. Writes every
  // element.
  virtual void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept = 0;
  // h: what the sensor measures, without its white noise, is h'x.
  [[nodiscard]] virtual Eigen::VectorXd measurement() const = 0;
  // The part of h that is the sensor's rate, level and manoeuvre, and is published. In a sum the terms that
  // carry the level; the other states (a colour, a line, tuned at rest) are noise: the filter has to
  // know it, nobody wants to see it.
  [[nodiscard]] virtual Eigen::VectorXd rate() const { return measurement(); }
  // The direction in which the state moves when the rate changes by one; h'level = 1. Used to follow a
  // manoeuvre.
  [[nodiscard]] virtual Eigen::VectorXd level() const = 0;
  // Whether a lasting change of rate belongs in this term rather than in a sum's other ones. Where no term
  // of a sum says so, its first one carries it.
  [[nodiscard]] virtual bool carries_level() const noexcept { return false; }
  // Stationary covariance for unit q, with zero rows for states that have none (those are listed in
  // diffuse()).
  [[nodiscard]] virtual Eigen::MatrixXd stationary() const = 0;
  // 1 for the states of stationary noise that is not part of the rate (the colour), 0 for the others.
  [[nodiscard]] virtual Eigen::VectorXd colour() const { return Eigen::VectorXd::Zero(states()); }
  // For each state that wanders without bound its variance before the first measurement, as a multiple of the
  // rate's; zero for the others.
  [[nodiscard]] virtual Eigen::VectorXd diffuse() const = 0;
  // The same for a filter whose rate is published from the first sample on. A line then begins a million
  // times smaller than the rate: were they alike, the first samples could not tell one from the other's
  // phase, and both would begin far from either.
  [[nodiscard]] virtual Eigen::VectorXd start() const { return diffuse(); }
};

// Throws std::invalid_argument naming the setting, its value and what was expected.
std::unique_ptr<StateModel> make_state_model(const std::string& name, std::span<const double> parameters,
                                             double nominal_period_s);

// The names above, as the command line lists them.
std::vector<std::string> state_model_names();

// What a name that is none of them, or one term of a sum, should have been.
std::string expected_state_model(const std::string& written);

}  // namespace ifog
