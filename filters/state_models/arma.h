// SPDX-License-Identifier: Apache-2.0
// ARMA(p,q) in Harvey's state-space form with max(p, q+1) states: Harvey, "Forecasting, Structural Time
// Series Models and the Kalman Filter", section 3.3. The coefficients describe the process without R; an
// autoregression fitted to noisy output would count the white noise twice.
#pragma once

#include <vector>

#include "filters/state_models/state_model.h"

namespace ifog {

class Arma final : public StateModel {
 public:
  // Throws std::invalid_argument if the process is not stationary.
  Arma(std::vector<double> phi, std::vector<double> theta, double nominal_period_s);

  [[nodiscard]] int states() const noexcept override { return states_; }
  // dt is rounded to a whole number of nominal periods, at least one.
  void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept override;
  [[nodiscard]] Eigen::VectorXd measurement() const override;
  [[nodiscard]] Eigen::VectorXd level() const override;
  [[nodiscard]] Eigen::MatrixXd stationary() const override { return stationary_; }
  [[nodiscard]] Eigen::VectorXd diffuse() const override { return Eigen::VectorXd::Zero(states_); }

 private:
  using FewStates = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;

  int states_;
  double period_s_;
  std::vector<double> phi_;
  FewStates transition_, driving_;
  Eigen::MatrixXd stationary_;
};

}  // namespace ifog
