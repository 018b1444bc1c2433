// SPDX-License-Identifier: Apache-2.0
#include "filters/state_models/arma.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "filters/state_models/spectral_radius.h"

namespace ifog {

Arma::Arma(std::vector<double> phi, std::vector<double> theta, double nominal_period_s)
    : states_(static_cast<int>(std::max(phi.size(), theta.size() + 1))),
      period_s_(nominal_period_s),
      phi_(std::move(phi)) {
  const int n = states_;
  phi_.resize(static_cast<std::size_t>(n), 0.0);
  theta.resize(static_cast<std::size_t>(n - 1), 0.0);
  transition_.setZero(n, n);
  Eigen::VectorXd shock(n);
  shock(0) = 1.0;
  for (int i = 0; i < n; ++i) {
    transition_(i, 0) = phi_[static_cast<std::size_t>(i)];
    if (i > 0) {
      transition_(i - 1, i) = 1.0;
      shock(i) = theta[static_cast<std::size_t>(i - 1)];
    }
  }
  driving_ = period_s_ * shock * shock.transpose();

  const double largest = spectral_radius(transition_);
  if (!(largest < 1.0)) {
    throw std::invalid_argument("state_parameters: autoregression with a root of modulus " +
                                std::to_string(largest) + ", expected a stationary one, all below 1");
  }
  // P = Q + A Q A' + A² Q A'² + …, doubling the number of terms. Without convergence the root is practically
  // 1.
  constexpr int kMostDoublings = 64;
  FewStates power = transition_, sum = driving_;
  for (int i = 0; i < kMostDoublings; ++i) {
    const FewStates more = power.lazyProduct(sum.lazyProduct(power.transpose()).eval());
    sum += more;
    power = power.lazyProduct(power).eval();
    if (more.norm() <= 1e-17 * sum.norm()) break;
  }
  stationary_ = 0.5 * (sum + sum.transpose());
}

void Arma::discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept {
  // Beyond this the covariance is practically the stationary one.
  constexpr long kMostSteps = 4096;
  const long steps = std::clamp(std::lround(std::min(dt_s / period_s_, 1e6)), 1L, kMostSteps);
  FewStates a = transition_, q = driving_;
  for (long i = 1; i < steps; ++i) {
    q = (transition_.lazyProduct(q.lazyProduct(transition_.transpose()).eval()) + driving_).eval();
    a = transition_.lazyProduct(a).eval();
  }
  transition = a;
  driving = q;
}

Eigen::VectorXd Arma::measurement() const { return Eigen::VectorXd::Unit(states_, 0); }

Eigen::VectorXd Arma::level() const {
  // State of a process that is constant at one: element i has the remaining share.
  Eigen::VectorXd level = Eigen::VectorXd::Unit(states_, 0);
  double ahead = 0.0;
  for (int i = states_ - 1; i > 0; --i) {
    ahead += phi_[static_cast<std::size_t>(i)];
    level(i) = ahead;
  }
  return level;
}

}  // namespace ifog
