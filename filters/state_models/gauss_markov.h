// SPDX-License-Identifier: Apache-2.0
// First-order Gauss-Markov process: exponentially correlated, stationary.
#pragma once

#include <cmath>

#include "filters/state_models/state_model.h"

namespace ifog {

class GaussMarkov final : public StateModel {
 public:
  explicit GaussMarkov(double correlation_time_s) : tau_s_(correlation_time_s) {}
  [[nodiscard]] int states() const noexcept override { return 1; }
  void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept override {
    transition(0, 0) = std::exp(-dt_s / tau_s_);
    driving(0, 0) = -0.5 * tau_s_ * std::expm1(-2.0 * dt_s / tau_s_);
  }
  [[nodiscard]] Eigen::VectorXd measurement() const override { return Eigen::VectorXd::Ones(1); }
  [[nodiscard]] Eigen::VectorXd level() const override { return Eigen::VectorXd::Ones(1); }
  [[nodiscard]] Eigen::MatrixXd stationary() const override {
    return Eigen::MatrixXd::Constant(1, 1, 0.5 * tau_s_);
  }
  [[nodiscard]] Eigen::VectorXd diffuse() const override { return Eigen::VectorXd::Zero(1); }

 private:
  double tau_s_;
};

}  // namespace ifog
