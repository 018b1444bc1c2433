// SPDX-License-Identifier: Apache-2.0
// Model of the rate between samples: x(k+1) = A x(k) + w, rate = h'x; A and cov w depend on the time between
// samples. The axes of a sensor share one model.
//
// Names and parameters (FilterSettings::state, ::state_parameters), q = process_noise in (rad/s)^2/s:
//   random-walk                    -            driven by q
//   integrated-random-walk         -            the slope is driven by q, then in (rad/s^2)^2/s
//   gauss-markov      correlation time s        driven by q; stationary variance q tau / 2
//   ar(p)             phi_1 … phi_p             y_k = sum phi_i y_{k-i} + e_k, var e = q * nominal period
//   arma(p,q)         phi_1 … phi_p, theta_1 …  y_k = sum phi_i y_{k-i} + e_k + sum theta_i e_{k-i}
//   harmonic          frequency Hz              two quadrature states, each driven by q
// Sums are written with " + ". Each term after the first has one more parameter at its end: the ratio of its
// driving noise to q. "random-walk + harmonic" with {4.17, 0.1}: a line at 4.17 Hz whose states are driven by
// 0.1 q.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ifog {

inline constexpr int kMaxStates = 8;

// Column-major n x n view of the filter's fixed-size matrices, so nothing allocates.
using StateMatrixRef = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

class StateModel {
 public:
  virtual ~StateModel() = default;

  [[nodiscard]] virtual int states() const noexcept = 0;
  // Transition over dt seconds and covariance of the driving noise in that time, for unit q. Writes every
  // element.
  virtual void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept = 0;
  // h: the measurement without its white noise is h'x.
  [[nodiscard]] virtual Eigen::VectorXd measurement() const = 0;
  // Part of h that is the sensor's rate and is published. In a sum these are the terms that carry the level;
  // other states (colour, lines) are noise.
  [[nodiscard]] virtual Eigen::VectorXd rate() const { return measurement(); }
  // Change of the state if the rate changes by one; h'level = 1. Used to follow a manoeuvre.
  [[nodiscard]] virtual Eigen::VectorXd level() const = 0;
  // True if a lasting change of rate belongs to this term of a sum. If no term says so, the first one carries
  // it.
  [[nodiscard]] virtual bool carries_level() const noexcept { return false; }
  // Stationary covariance for unit q, with zero rows for states that have none (see diffuse()).
  [[nodiscard]] virtual Eigen::MatrixXd stationary() const = 0;
  // The same of stationary noise that is not part of the rate (the colour), with zero rows for other states.
  [[nodiscard]] virtual Eigen::MatrixXd colour() const { return Eigen::MatrixXd::Zero(states(), states()); }
  // Variance of the colour in a measurement, for unit q.
  [[nodiscard]] double colour_variance() const {
    const Eigen::VectorXd h = measurement();
    return h.dot(colour() * h);
  }
  // For each non-stationary state its variance before the first measurement, as a multiple of the rate's;
  // zero for the others.
  [[nodiscard]] virtual Eigen::VectorXd diffuse() const = 0;
  // The same for a filter whose rate is published from the first sample on. A line then starts a million
  // times smaller, because the first samples cannot distinguish the rate from the line's phase.
  [[nodiscard]] virtual Eigen::VectorXd start() const { return diffuse(); }
};

// Throws std::invalid_argument that names the setting, its value and what was expected.
std::unique_ptr<StateModel> make_state_model(const std::string& name, std::span<const double> parameters,
                                             double nominal_period_s);

// The names above, for the command line.
std::vector<std::string> state_model_names();

// What was expected instead of an invalid name.
std::string expected_state_model(const std::string& written);

}  // namespace ifog
