// SPDX-License-Identifier: Apache-2.0
// Line with slowly varying amplitude and phase: in-phase and quadrature state, rotated by 2 pi f dt, with
// equal driving noise.
#pragma once

#include <cmath>
#include <numbers>

#include "filters/state_models/state_model.h"

namespace ifog {

class Harmonic final : public StateModel {
 public:
  explicit Harmonic(double frequency_hz) : frequency_hz_(frequency_hz) {}
  [[nodiscard]] int states() const noexcept override { return 2; }
  void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept override {
    const double turned = 2.0 * std::numbers::pi * frequency_hz_ * dt_s;
    transition(0, 0) = transition(1, 1) = std::cos(turned);
    transition(0, 1) = std::sin(turned);
    transition(1, 0) = -transition(0, 1);
    driving(0, 0) = driving(1, 1) = dt_s;
    driving(0, 1) = driving(1, 0) = 0.0;
  }
  [[nodiscard]] Eigen::VectorXd measurement() const override { return Eigen::Vector2d(1.0, 0.0); }
  [[nodiscard]] Eigen::VectorXd level() const override { return Eigen::Vector2d(1.0, 0.0); }
  [[nodiscard]] Eigen::MatrixXd stationary() const override { return Eigen::MatrixXd::Zero(2, 2); }
  [[nodiscard]] Eigen::VectorXd diffuse() const override { return Eigen::VectorXd::Ones(2); }
  [[nodiscard]] Eigen::VectorXd start() const override { return Eigen::VectorXd::Constant(2, 1e-7); }

 private:
  double frequency_hz_;
};

}  // namespace ifog
