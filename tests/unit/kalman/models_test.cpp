// SPDX-License-Identifier: Apache-2.0
// State models against closed forms: matrices against their definition, the likelihood of a line and of sums
// against the normal density of the whole record with its dense covariance.
#include "filters/kalman/core.h"
#include "filters/kalman/likelihood.h"
#include "filters/state_models/state_model.h"
#include "tests/unit/test.h"

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
constexpr int kLength = 90;

using Covariance = std::function<long double(int i, int j)>;

// Of an ARMA process, from its infinite moving average for unit shocks.
Covariance arma(const std::vector<double>& phi, const std::vector<double>& theta) {
  std::vector<long double> psi(20'000, 0.0L), gamma(kLength, 0.0L);
  for (std::size_t i = 0; i < psi.size(); ++i) {
    psi[i] = i == 0 ? 1.0L : i <= theta.size() ? theta[i - 1] : 0.0L;
    for (std::size_t j = 0; j < phi.size() && j < i; ++j) psi[i] += phi[j] * psi[i - 1 - j];
  }
  for (std::size_t k = 0; k < gamma.size(); ++k)
    for (std::size_t i = 0; i + k < psi.size(); ++i) gamma[k] += psi[i] * psi[i + k];
  return [gamma](int i, int j) { return kQ * kPeriod_s * gamma[static_cast<std::size_t>(std::abs(i - j))]; };
}

struct Case {
  const char* name;
  std::vector<double> parameters;
  long diffuse;
  Covariance covariance;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class ModelLikelihood : public testing::TestWithParam<Case> {};

// Also with a missing sample, which is a row and a column that are not there.
TEST_P(ModelLikelihood, IsThatOfTheDenseCovariance) {
  const Case& c = GetParam();
  ifog::test::Noise normal(21);
  std::vector<double> record;
  for (int i = 0; i < kLength; ++i) record.push_back(3e-4 * std::sin(0.8 * i + 0.3) + 1e-3 + 2e-4 * normal());
  const auto model = ifog::make_state_model(c.name, c.parameters, kPeriod_s);
  for (const int missing : {kLength, 40}) {
    std::vector<int> at;
    for (int i = 0; i < kLength; ++i)
      if (i != missing) at.push_back(i);
    const auto n = static_cast<Eigen::Index>(at.size());
    Matrix covariance(n, n);
    Vector dense_record(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      dense_record(i) = record[static_cast<std::size_t>(at[static_cast<std::size_t>(i)])];
      for (Eigen::Index j = 0; j < n; ++j)
        covariance(i, j) = c.covariance(at[static_cast<std::size_t>(i)], at[static_cast<std::size_t>(j)]) +
                           (i == j ? kR : 0.0L);
    }
    std::vector<double> measured = record;
    if (missing < kLength) measured[static_cast<std::size_t>(missing)] = std::nan("");
    const std::span<const double> axes[] = {measured};
    const auto terms = ifog::likelihood(*model, kQ, kR, ifog::LikelihoodRecord(axes), kPeriod_s);
    EXPECT_EQ(terms.count, n - c.diffuse);
    // Either side is off the diffuse limit by some 1e-9 of itself a state.
    EXPECT_NEAR(terms.log_likelihood(),
                static_cast<double>(dense_given_first(covariance, dense_record, c.diffuse)),
                c.diffuse > 0 ? 1e-4 : 1e-7)
        << missing;
  }
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
        Case{"ar(1)", {0.9}, 0, arma({0.9}, {})}, Case{"ar(2)", {1.5, -0.7}, 0, arma({1.5, -0.7}, {})},
        Case{"arma(1,1)", {0.8, -0.4}, 0, arma({0.8}, {-0.4})},
        Case{"arma(2,2)", {0.6, 0.2, 0.5, 0.3}, 0, arma({0.6, 0.2}, {0.5, 0.3})},
        Case{"arma(0,2)", {0.7, -0.2}, 0, arma({}, {0.7, -0.2})},
        Case{"ar(1) + random-walk + harmonic", {0.7, 0.5, 8.34, 0.01}, 3, [](int i, int j) {
               return autoregression(i, j, 0.7L, kQ) + walk(i, j, 0.5L * kQ, kStart) +
                      line(i, j, 8.34L, 0.01L * kQ, kStart);
             }}));

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

// Steady-state gains against closed forms of the algebraic Riccati equation.

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
  model.discretise(kPeriod_s, a, q);
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
  const auto model = ifog::make_state_model(c.name, c.parameters, kPeriod_s);
  ifog::test::Noise normal(17);
  std::vector<std::vector<double>> axes(3);
  double slow = 0.0, fast = 0.0;
  for (std::size_t k = 0; k < kLength; ++k) {
    for (auto& axis : axes) {
      slow += 1e-4 * normal();
      fast = 0.8 * fast + 0.3 * normal();
      axis.push_back(slow + fast + normal());
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
      ifog::likelihood(*model, c.process, c.measurement, ifog::LikelihoodRecord(spans), kPeriod_s);
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
