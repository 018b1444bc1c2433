// SPDX-License-Identifier: Apache-2.0
// Steady-state gains against closed forms of the algebraic Riccati equation.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/kalman/core.h"
#include "filters/state_models/state_model.h"

namespace {

template <int n>
Eigen::Matrix<double, n, 1> settled_gain(const char* name, double process_noise, double measurement_noise,
                                         double period_s) {
  const auto model = ifog::make_state_model(name, {}, period_s);
  ifog::KalmanCore<n> core;
  core.h = model->measurement();
  Eigen::Matrix<double, n, n> transition, driving;
  model->discretise(period_s, transition, driving);
  driving *= process_noise;
  core.p.diagonal() = measurement_noise * model->diffuse();
  for (int i = 0; i < 20000; ++i) {
    core.predict(transition, driving);
    core.correct(core.h.dot(core.p * core.h) + measurement_noise);
  }
  return core.gain;
}

// Random walk: P-^2 = q (P- + R), so K = (sqrt(L^2 + 4 L) - L) / 2 with L = q / R.
TEST(Riccati, RandomWalkGainIsTheClosedForm) {
  for (const double ratio : {1e-6, 1e-3, 0.1, 1.0, 50.0}) {
    const double exact = (std::sqrt(ratio * ratio + 4 * ratio) - ratio) / 2;
    const double period = 0.005;
    EXPECT_NEAR(settled_gain<1>("random-walk", ratio / period, 1.0, period)(0) / exact, 1.0, 1e-10) << ratio;
  }
}

// Integrated random walk driven by continuous white noise, L^2 = q T^3 / R. The element (2,2) of the Riccati
// equation gives beta^2 = L^2 (1 - alpha); eliminating P22 between (1,2) and (1,1) gives alpha^2 + beta^2 / 6
// = beta (2 - alpha).
TEST(Riccati, IntegratedRandomWalkIsTheAlphaBetaFilter) {
  for (const double index_squared : {1e-8, 1e-4, 1e-2, 1.0}) {
    const double period = 0.01;
    const double q = index_squared / (period * period * period);
    const Eigen::Vector2d gain = settled_gain<2>("integrated-random-walk", q, 1.0, period);
    const double alpha = gain(0);
    const double beta = gain(1) * period;
    EXPECT_NEAR(beta * beta / (1 - alpha) / index_squared, 1.0, 1e-8) << index_squared;
    EXPECT_NEAR((alpha * alpha + beta * beta / 6) / (2 * beta - alpha * beta), 1.0, 1e-8) << index_squared;
  }
}

}  // namespace
