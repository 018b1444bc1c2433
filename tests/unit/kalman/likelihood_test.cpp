// SPDX-License-Identifier: Apache-2.0
// The likelihood against the multivariate normal density of the whole record with its dense covariance
// matrix. The autocovariances come from the process's own definition, not from the state-space form under
// test.
#include "filters/kalman/likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace {

constexpr double kPeriod = 0.01;

// Autocovariance of an ARMA process for unit shocks, from its infinite moving average.
std::vector<double> autocovariance(std::vector<double> phi, std::vector<double> theta, std::size_t lags) {
  std::vector<double> psi(20000, 0.0);
  for (std::size_t i = 0; i < psi.size(); ++i) {
    psi[i] = i == 0 ? 1.0 : (i <= theta.size() ? theta[i - 1] : 0.0);
    for (std::size_t j = 0; j < phi.size() && j < i; ++j) psi[i] += phi[j] * psi[i - 1 - j];
  }
  std::vector<double> gamma(lags, 0.0);
  for (std::size_t k = 0; k < lags; ++k) {
    for (std::size_t i = 0; i + k < psi.size(); ++i) gamma[k] += psi[i] * psi[i + k];
  }
  return gamma;
}

double dense_log_likelihood(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& record) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const double log_determinant = 2.0 * Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum();
  const Eigen::VectorXd white = factor.matrixL().solve(record);
  return -0.5 * (static_cast<double>(record.size()) * std::log(2 * std::numbers::pi) + log_determinant +
                 white.squaredNorm());
}

struct ArmaCase {
  const char* name;
  std::vector<double> phi, theta;
};

void PrintTo(const ArmaCase& c, std::ostream* out) { *out << c.name; }

class ArmaLikelihood : public testing::TestWithParam<ArmaCase> {};

TEST_P(ArmaLikelihood, IsThatOfTheDenseCovariance) {
  const ArmaCase& c = GetParam();
  constexpr int kLength = 120;
  constexpr double kProcess = 3e-6, kMeasurement = 2e-8;
  const std::vector<double> gamma = autocovariance(c.phi, c.theta, kLength);
  Eigen::MatrixXd covariance(kLength, kLength);
  for (int i = 0; i < kLength; ++i) {
    for (int j = 0; j < kLength; ++j) {
      covariance(i, j) = kProcess * kPeriod * gamma[static_cast<std::size_t>(std::abs(i - j))];
    }
  }
  covariance.diagonal().array() += kMeasurement;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Eigen::VectorXd white(kLength);
  for (double& value : white) value = normal(random);
  const Eigen::VectorXd drawn = Eigen::MatrixXd(covariance.llt().matrixL()) * white;

  std::vector<double> parameters = c.phi;
  parameters.insert(parameters.end(), c.theta.begin(), c.theta.end());
  const auto model = ifog::make_state_model(c.name, parameters, kPeriod);
  std::vector<double> record(drawn.begin(), drawn.end());
  EXPECT_NEAR(ifog::likelihood(*model, kProcess, kMeasurement, record, kPeriod).log_likelihood(),
              dense_log_likelihood(covariance, drawn), 1e-7);

  // A missing sample is a row and a column that are not there.
  constexpr int kMissing = 40;
  record[kMissing] = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd without(kLength - 1, kLength - 1);
  Eigen::VectorXd kept(kLength - 1);
  for (int i = 0; i < kLength - 1; ++i) {
    const int from_i = i < kMissing ? i : i + 1;
    kept(i) = drawn(from_i);
    for (int j = 0; j < kLength - 1; ++j) without(i, j) = covariance(from_i, j < kMissing ? j : j + 1);
  }
  EXPECT_NEAR(ifog::likelihood(*model, kProcess, kMeasurement, record, kPeriod).log_likelihood(),
              dense_log_likelihood(without, kept), 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Orders, ArmaLikelihood,
                         testing::Values(ArmaCase{"ar(1)", {0.9}, {}}, ArmaCase{"ar(2)", {1.5, -0.7}, {}},
                                         ArmaCase{"arma(1,1)", {0.8}, {-0.4}},
                                         ArmaCase{"arma(2,2)", {0.6, 0.2}, {0.5, 0.3}},
                                         ArmaCase{"arma(0,2)", {}, {0.7, -0.2}}));

// The filter's equations by the textbook, one covariance step a sample, for a long record: what holding the
// gain costs. Three axes and missing samples go through the same covariance.
struct Long {
  const char* name;
  std::vector<double> parameters;
  double process, measurement;
  bool missing;
};

void PrintTo(const Long& c, std::ostream* out) { *out << c.name << (c.missing ? " with gaps" : ""); }

class LongLikelihood : public testing::TestWithParam<Long> {};

double step_by_step(const ifog::StateModel& model, double process, double measurement,
                    const std::vector<double>& record) {
  const int n = model.states();
  Eigen::MatrixXd a(n, n), q(n, n);
  model.discretise(kPeriod, a, q);
  q *= process;
  const Eigen::VectorXd h = model.measurement();
  Eigen::MatrixXd p = process * model.stationary();
  p.diagonal() += 1e9 * (measurement + process) * model.diffuse();
  Eigen::VectorXd x = model.level() * record[0];
  const long uncounted = (model.diffuse().array() > 0).count();
  double sum = 0.0;
  long measured = 0;
  for (const double z : record) {
    if (std::isfinite(z)) {
      const double s = h.dot(p * h) + measurement, innovation = z - h.dot(x);
      const Eigen::VectorXd gain = p * h / s;
      x += gain * innovation;
      const Eigen::MatrixXd keep = Eigen::MatrixXd::Identity(n, n) - gain * h.transpose();
      p = keep * p * keep.transpose() + measurement * gain * gain.transpose();
      if (++measured > uncounted)
        sum -= 0.5 * (std::log(2 * std::numbers::pi * s) + innovation * innovation / s);
    }
    x = a * x;
    p = a * p * a.transpose() + q;
  }
  return sum;
}

TEST_P(LongLikelihood, HoldsTheGainWithoutBeingSeen) {
  const Long& c = GetParam();
  constexpr std::size_t kLength = 60'000;
  const auto model = ifog::make_state_model(c.name, c.parameters, kPeriod);
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> axes(3);
  double slow = 0.0, fast = 0.0;
  for (std::size_t k = 0; k < kLength; ++k) {
    for (auto& axis : axes) {
      slow += 1e-4 * normal(random);
      fast = 0.8 * fast + 0.3 * normal(random);
      axis.push_back(slow + fast + normal(random));
    }
  }
  if (c.missing) {
    for (auto& axis : axes) {
      for (std::size_t k = 20'000; k < 20'300; ++k) axis[k] = std::nan("");
      for (std::size_t k = 30'000; k < 31'000; k += 37) axis[k] = std::nan("");
    }
    // One axis alone: it cannot share the covariance of the others.
    axes[2][40'000] = std::nan("");
  }
  double expected = 0.0;
  for (const auto& axis : axes) expected += step_by_step(*model, c.process, c.measurement, axis);
  const std::vector<std::span<const double>> spans(axes.begin(), axes.end());
  const auto terms =
      ifog::likelihood(*model, c.process, c.measurement, ifog::LikelihoodRecord(spans), kPeriod);
  EXPECT_NEAR(terms.log_likelihood(), expected, 0.01);
}

INSTANTIATE_TEST_SUITE_P(
    Models, LongLikelihood,
    testing::Values(Long{"random-walk", {}, 1e-6, 1.2, false}, Long{"random-walk", {}, 1e-10, 1.2, true},
                    Long{"random-walk + ar(1)", {0.8, 1e6}, 1e-5, 1.0, true},
                    Long{"random-walk + gauss-markov", {30.0, 1e3}, 1e-8, 1.1, false},
                    Long{"random-walk + arma(3,2)", {1.2, -0.5, 0.1, 0.3, 0.2, 1e5}, 1e-5, 0.7, true},
                    Long{"random-walk + harmonic", {4.17, 1e-2}, 1e-6, 1.2, false}));

}  // namespace
