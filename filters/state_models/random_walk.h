// SPDX-License-Identifier: Apache-2.0
// Random walk and integrated random walk: the rate, or its slope, makes independent steps.
#pragma once

#include "filters/state_models/state_model.h"

namespace ifog {

class RandomWalk final : public StateModel {
 public:
  [[nodiscard]] int states() const noexcept override { return 1; }
  void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept override {
    transition(0, 0) = 1.0;
    driving(0, 0) = dt_s;
  }
  [[nodiscard]] Eigen::VectorXd measurement() const override { return Eigen::VectorXd::Ones(1); }
  [[nodiscard]] Eigen::VectorXd level() const override { return Eigen::VectorXd::Ones(1); }
  [[nodiscard]] bool carries_level() const noexcept override { return true; }
  [[nodiscard]] Eigen::MatrixXd stationary() const override { return Eigen::MatrixXd::Zero(1, 1); }
  [[nodiscard]] Eigen::VectorXd diffuse() const override { return Eigen::VectorXd::Ones(1); }
};

// States: rate and slope. Driving covariance of doubly integrated white noise: Bar-Shalom, Li and
// Kirubarajan, "Estimation with Applications to Tracking and Navigation", eq. 6.2.2-12.
class IntegratedRandomWalk final : public StateModel {
 public:
  explicit IntegratedRandomWalk(double nominal_period_s) : period_s_(nominal_period_s) {}
  [[nodiscard]] int states() const noexcept override { return 2; }
  void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept override {
    const double dt2 = dt_s * dt_s;
    transition(0, 0) = transition(1, 1) = 1.0;
    transition(0, 1) = dt_s;
    transition(1, 0) = 0.0;
    driving(0, 0) = dt2 * dt_s / 3.0;
    driving(0, 1) = driving(1, 0) = dt2 / 2.0;
    driving(1, 1) = dt_s;
  }
  [[nodiscard]] Eigen::VectorXd measurement() const override { return Eigen::Vector2d(1.0, 0.0); }
  [[nodiscard]] Eigen::VectorXd level() const override { return Eigen::Vector2d(1.0, 0.0); }
  [[nodiscard]] bool carries_level() const noexcept override { return true; }
  [[nodiscard]] Eigen::MatrixXd stationary() const override { return Eigen::MatrixXd::Zero(2, 2); }
  [[nodiscard]] Eigen::VectorXd diffuse() const override {
    return Eigen::Vector2d(1.0, 1.0 / (period_s_ * period_s_));
  }

 private:
  double period_s_;
};

}  // namespace ifog
