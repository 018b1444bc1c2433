// SPDX-License-Identifier: Apache-2.0
// State models against closed forms: matrices against their definition, the likelihood of a line and of sums
// against the normal density of the whole record with its dense covariance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "filters/kalman/likelihood.h"
#include "filters/state_models/state_model.h"

namespace {

constexpr double kPeriod_s = 0.01;

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

long double dense(const Matrix& covariance, const Vector& record) {
  const Eigen::LLT<Matrix> factor(covariance);
  const Vector white = factor.matrixL().solve(record);
  return -0.5L * (static_cast<long double>(record.size()) * std::log(2 * std::numbers::pi_v<long double>) +
                  2 * Matrix(factor.matrixL()).diagonal().array().log().sum() + white.squaredNorm());
}

// With `diffuse` states that wander without bound the first so many measurements only fix where they start:
// the likelihood of the others, given them.
long double dense_given_first(const Matrix& covariance, const Vector& record, long diffuse) {
  return dense(covariance, record) -
         (diffuse > 0 ? dense(covariance.topLeftCorner(diffuse, diffuse), record.head(diffuse)) : 0.0L);
}

// Covariance between samples i and j of each kind of term, for driving noise q, from its definition. A
// wandering one starts with variance `start`.
long double walk(int i, int j, long double q, long double start) {
  return start + q * kPeriod_s * std::min(i, j);
}
// In-phase and quadrature state turned by the same angle at each step, both driven: what entered at step m
// reaches i and j turned apart by the angle between them.
long double line(int i, int j, long double frequency, long double q, long double start) {
  return (start + q * kPeriod_s * std::min(i, j)) *
         std::cos(2 * std::numbers::pi_v<long double> * frequency * kPeriod_s * (j - i));
}
long double markov(int i, int j, long double tau, long double q) {
  return 0.5L * q * tau * std::exp(-std::abs(i - j) * static_cast<long double>(kPeriod_s) / tau);
}
long double autoregression(int i, int j, long double phi, long double q) {
  return q * kPeriod_s * std::pow(phi, static_cast<long double>(std::abs(i - j))) / (1 - phi * phi);
}

constexpr double kQ = 3e-7, kR = 4e-8;
constexpr long double kStart = 1e10L * kR;

struct Case {
  const char* name;
  std::vector<double> parameters;
  long diffuse;
  long double (*covariance)(int i, int j);
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class ModelLikelihood : public testing::TestWithParam<Case> {};

TEST_P(ModelLikelihood, IsThatOfTheDenseCovariance) {
  const Case& c = GetParam();
  constexpr int kLength = 90;
  Matrix covariance(kLength, kLength);
  for (int i = 0; i < kLength; ++i) {
    for (int j = 0; j < kLength; ++j) covariance(i, j) = c.covariance(i, j) + (i == j ? kR : 0.0L);
  }
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  std::vector<double> record;
  for (int i = 0; i < kLength; ++i)
    record.push_back(3e-4 * std::sin(0.8 * i + 0.3) + 1e-3 + 2e-4 * normal(random));
  const Vector dense_record = Eigen::Map<const Eigen::VectorXd>(record.data(), kLength).cast<long double>();

  const auto model = ifog::make_state_model(c.name, c.parameters, kPeriod_s);
  const auto terms = ifog::likelihood(*model, kQ, kR, record, kPeriod_s);
  EXPECT_EQ(terms.count, kLength - c.diffuse);
  // Either side is off the diffuse limit by some 1e-9 of itself a state.
  EXPECT_NEAR(terms.log_likelihood(),
              static_cast<double>(dense_given_first(covariance, dense_record, c.diffuse)),
              c.diffuse > 0 ? 1e-4 : 1e-7);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, ModelLikelihood,
    testing::Values(
        Case{"random-walk", {}, 1, [](int i, int j) { return walk(i, j, kQ, kStart); }},
        Case{"gauss-markov", {0.2}, 0, [](int i, int j) { return markov(i, j, 0.2L, kQ); }},
        Case{"harmonic", {4.17}, 2, [](int i, int j) { return line(i, j, 4.17L, kQ, kStart); }},
        Case{"random-walk + harmonic",
             {12.3, 0.2},
             3,
             [](int i, int j) { return walk(i, j, kQ, kStart) + line(i, j, 12.3L, 0.2L * kQ, kStart); }},
        Case{"gauss-markov + ar(1)",
             {0.3, -0.6, 5.0},
             0,
             [](int i, int j) { return markov(i, j, 0.3L, kQ) + autoregression(i, j, -0.6L, 5 * kQ); }},
        Case{"ar(1) + random-walk + harmonic", {0.7, 0.5, 8.34, 0.01}, 3, [](int i, int j) {
               return autoregression(i, j, 0.7L, kQ) + walk(i, j, 0.5L * kQ, kStart) +
                      line(i, j, 8.34L, 0.01L * kQ, kStart);
             }}));

// The state turns by 2 pi f dt, and as a turn keeps an isotropic covariance, integral of A(s) A(s)' ds is dt
// times the identity (the Lyapunov equation P' = W P + P W' + I of a skew W).
TEST(Harmonic, TurnsByItsFrequencyAndGathersNoiseInTime) {
  const auto model = ifog::make_state_model("harmonic", std::vector{3.3}, kPeriod_s);
  Eigen::MatrixXd transition(2, 2), driving(2, 2);
  for (const double dt : {0.01, 0.1, 7.0}) {
    model->discretise(dt, transition, driving);
    const double angle = 2 * std::numbers::pi * 3.3 * dt;
    Eigen::Matrix2d turn;
    turn << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
    EXPECT_LT((transition - turn).norm(), 1e-12) << dt;
    EXPECT_LT((driving - dt * Eigen::Matrix2d::Identity()).norm(), 1e-12) << dt;
  }
}

// Blocks of the terms on the diagonal, nothing outside them, noise by each one's ratio, measurement the sum.
TEST(Sum, IsBlockDiagonal) {
  const auto sum = ifog::make_state_model("integrated-random-walk + gauss-markov + harmonic",
                                          std::vector{0.5, 0.1, 3.3, 0.25}, kPeriod_s);
  const auto first = ifog::make_state_model("integrated-random-walk", {}, kPeriod_s);
  const auto second = ifog::make_state_model("gauss-markov", std::vector{0.5}, kPeriod_s);
  const auto third = ifog::make_state_model("harmonic", std::vector{3.3}, kPeriod_s);
  Eigen::MatrixXd transition(5, 5), driving(5, 5);
  sum->discretise(0.03, transition, driving);
  Eigen::MatrixXd expected_transition = Eigen::MatrixXd::Zero(5, 5), expected_driving = expected_transition;
  Eigen::VectorXd measurement(5);
  int at = 0;
  for (const auto& [model, ratio] : {std::pair{&first, 1.0}, {&second, 0.1}, {&third, 0.25}}) {
    const int n = (*model)->states();
    Eigen::MatrixXd a(n, n), q(n, n);
    (*model)->discretise(0.03, a, q);
    expected_transition.block(at, at, n, n) = a;
    expected_driving.block(at, at, n, n) = ratio * q;
    measurement.segment(at, n) = (*model)->measurement();
    at += n;
  }
  EXPECT_EQ(transition, expected_transition);
  EXPECT_EQ(driving, expected_driving);
  EXPECT_EQ(sum->measurement(), measurement);
}

// The rate is what carries the level; without a term made for that, the first.
TEST(Sum, PublishesTheTermsThatCarryTheLevel) {
  const auto rate = [](const char* name, std::vector<double> parameters) {
    return ifog::make_state_model(name, parameters, kPeriod_s)->rate();
  };
  EXPECT_EQ(rate("gauss-markov + random-walk + harmonic", {0.5, 1.0, 3.3, 0.25}),
            (Eigen::Vector4d(0.0, 1.0, 0.0, 0.0)));
  EXPECT_EQ(rate("random-walk + ar(2) + integrated-random-walk", {0.5, 0.1, 1.0, 0.1}),
            (Eigen::Matrix<double, 5, 1>(1.0, 0.0, 0.0, 1.0, 0.0)));
  EXPECT_EQ(rate("gauss-markov + harmonic", {0.5, 3.3, 0.25}), (Eigen::Vector3d(1.0, 0.0, 0.0)));
  EXPECT_EQ(rate("ar(1)", {0.5}), (Eigen::Matrix<double, 1, 1>(1.0)));
}

}  // namespace
