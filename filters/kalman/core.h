// SPDX-License-Identifier: Apache-2.0
// Kalman filter of up to three axes that share model, noise and gain: one covariance, one gain vector, one
// state vector per axis. Different gains would delay the axes differently and turn coning into drift.
//
// Equations: Narasimhappa et al., "An innovation based random weighting estimation mechanism for denoising
// fiber optic gyro drift signal", eqs. (9)-(13). The adaptation rule gives the innovation covariance C; with
// C = h'P h + R this is the conventional filter.
#pragma once

#include <Eigen/Dense>

#include "filters/settings/axes.h"
#include "filters/state_models/state_model.h"

namespace ifog {

// Eq. (10): predicts the covariance, with `factor` times the driving covariance.
template <class Matrix>
void predict_covariance(Matrix& p, const Matrix& transition, const Matrix& driving,
                        double factor = 1.0) noexcept {
  const Matrix carried = transition.lazyProduct(p);
  p = carried.lazyProduct(transition.transpose()) + factor * driving;
}

// Gain and covariance for innovation covariance c >= h'P h, in Joseph form with R = c - h'P h: equal to (13),
// but stays positive despite rounding.
template <class Matrix, class Vector>
void correct_covariance(Matrix& p, Vector& gain, const Vector& h, double c) noexcept {
  const Vector ph = p.lazyProduct(h);
  gain = ph / c;
  const Matrix keep = Matrix::Identity(h.size(), h.size()) - gain.lazyProduct(h.transpose());
  const Matrix kept = keep.lazyProduct(p);
  const Matrix joseph =
      kept.lazyProduct(keep.transpose()) + (c - h.dot(ph)) * gain.lazyProduct(gain.transpose());
  p = 0.5 * (joseph + joseph.transpose());
}

// n: number of states, or Eigen::Dynamic for any number up to kMaxStates.
template <int n>
struct KalmanCore {
  static constexpr int kFixed = n == Eigen::Dynamic ? 0 : n, kMost = n == Eigen::Dynamic ? kMaxStates : n;
  using Vector = Eigen::Matrix<double, n, 1, Eigen::ColMajor, kMost, 1>;
  using Matrix = Eigen::Matrix<double, n, n, Eigen::ColMajor, kMost, kMost>;

  // One column per axis.
  using States =
      Eigen::Matrix<double, n, kMaxAxes, n == 1 ? Eigen::RowMajor : Eigen::ColMajor, kMost, kMaxAxes>;

  States x = States::Zero(kFixed, kMaxAxes);
  Matrix p = Matrix::Zero(kFixed, kFixed);  // common to all axes, (rad/s)^2
  Vector h = Vector::Zero(kFixed), gain = Vector::Zero(kFixed);

  // Eqs. (9), (10).
  void predict(const Matrix& transition, const Matrix& driving, double factor = 1.0) noexcept {
    if constexpr (n == 1) {
      x *= transition(0, 0);
      p(0, 0) = transition(0, 0) * transition(0, 0) * p(0, 0) + factor * driving(0, 0);
    } else {
      x = transition.lazyProduct(x).eval();
      predict_covariance(p, transition, driving, factor);
    }
  }

  // As correct_covariance(); a single state needs one division.
  void correct(double c) noexcept {
    if constexpr (n == 1) {
      gain(0) = p(0, 0) / c;
      p(0, 0) = gain(0) * (c - p(0, 0));
    } else {
      correct_covariance(p, gain, h, c);
    }
  }

  // Eq. (12) for one axis.
  void update(int axis, double innovation) noexcept { x.col(axis) += gain * innovation; }
};

}  // namespace ifog
