// SPDX-License-Identifier: Apache-2.0
// Rules against a straight transcription, for a scalar random walk, of the equations they were published
// with.
#include "filters/estimator/estimator.h"
#include "filters/rules/rule.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

constexpr double kPeriod = 0.01;
constexpr double kQ = 1e-3;  // per step, over R
constexpr double kR = 1.0;
constexpr int kWindow = 40;

std::vector<double> measurements() {
  ifog::test::Noise normal(17);
  std::vector<double> z(600);
  double x = 4.0;
  for (std::size_t k = 0; k < z.size(); ++k) {
    x += std::sqrt(kQ) * normal();
    z[k] = x + (k < 300 ? 1.0 : 3.0) * normal();  // noise that grows, so that adapting matters
  }
  return z;
}

// After the first measurement of a filter that knew nothing: the state is the measurement.
struct Scalar {
  double x, p;
};
Scalar started(double first) {
  const double prior = 1e6 * kR + kQ;
  return {first, prior * kR / (prior + kR)};
}

void expect_equal(const char* rule, const std::function<void(Scalar&, double, int)>& published,
                  double first_variance = started(0.0).p) {
  ifog::FilterSettings settings;
  settings.rule = rule;
  settings.process_noise = kQ / kPeriod;
  settings.measurement_noise = kR;
  settings.window = kWindow;
  settings.follow_manoeuvres = settings.conserve_angle = false;
  ifog::test::Fed filter(settings, 1, kPeriod);
  const std::vector<double> z = measurements();
  Scalar state{z[0], first_variance};
  for (std::size_t k = 0; k < z.size(); ++k) {
    const ifog::EstimatorOutput& out = filter.step({z[k]});
    if (k > 0) published(state, z[k], static_cast<int>(k));
    ASSERT_NEAR(out.denoised_radps[0], state.x, 1e-9) << "step " << k;
    ASSERT_NEAR(out.variance_rad2ps2[0] / state.p, 1.0, 1e-9) << "step " << k;
  }
}

TEST(PublishedEquations, SageHusa) {
  const double b = 1.0 - 1.0 / kWindow;
  double r = kR;
  expect_equal("sage-husa", [&](Scalar& s, double z, int k) {
    const double prior = s.p + kQ;
    const double innovation = z - s.x;
    const double d = (1 - b) / (1 - std::pow(b, k + 1));
    r = (1 - d) * r + d * (innovation * innovation - prior);
    r = std::max(r, 0.01 * kR);
    const double gain = prior / (prior + r);
    s.x += gain * innovation;
    s.p = (1 - gain) * prior;
  });
}

TEST(PublishedEquations, VariationalBayes) {
  const double rho = 1.0 - 1.0 / kWindow;
  double alpha = 1.0, beta = kR;
  expect_equal("vb", [&](Scalar& s, double z, int) {
    const double prior_mean = s.x, prior = s.p + kQ;
    alpha = rho * alpha + 0.5;
    const double beta_prior = rho * beta;
    beta = beta_prior;
    for (int turn = 0; turn < 3; ++turn) {
      const double sigma = beta / alpha;
      const double gain = prior / (prior + sigma);
      s.x = prior_mean + gain * (z - prior_mean);
      s.p = prior - gain * (prior + sigma) * gain;
      beta = beta_prior + 0.5 * (z - s.x) * (z - s.x) + 0.5 * s.p;
    }
  });
}

TEST(PublishedEquations, InnovationBasedEstimation) {
  std::vector<double> squares;
  expect_equal("iae", [&](Scalar& s, double z, int) {
    const double prior = s.p + kQ;
    const double innovation = z - s.x;
    squares.push_back(innovation * innovation);
    double c = prior + kR;
    if (squares.size() >= kWindow) {
      c = 0.0;
      for (std::size_t i = squares.size() - kWindow; i < squares.size(); ++i) c += squares[i] / kWindow;
      c = std::max(c, prior + 0.01 * kR);
    }
    const double gain = prior / c;
    s.x += gain * innovation;
    s.p = (1 - gain) * prior;
  });
}

TEST(PublishedEquations, ResidualBasedEstimation) {
  std::vector<double> terms;
  double r = kR;
  expect_equal("rae", [&](Scalar& s, double z, int) {
    const double prior = s.p + kQ;
    const double gain = prior / (prior + r);
    s.x += gain * (z - s.x);
    s.p = (1 - gain) * prior;
    const double residual = z - s.x;
    terms.push_back(residual * residual + s.p);
    if (terms.size() < kWindow) return;
    r = 0.0;
    for (std::size_t i = terms.size() - kWindow; i < terms.size(); ++i) r += terms[i] / kWindow;
  });
}

TEST(PublishedEquations, MultipleModelsByTheirLikelihood) {
  constexpr int kModels = 15;
  const auto process = [](int j) { return kQ * std::pow(100.0, j % 5 - 2); };
  const auto noise = [](int j) { return kR * std::pow(100.0, j / 5 - 1); };
  std::vector<Scalar> bank;
  std::vector<double> log_weight(kModels, 0.0);
  // After the first measurement each filter has its own noise, and all weigh the same.
  double first_variance = 0.0;
  for (int j = 0; j < kModels; ++j) {
    const double prior = 1e6 * kR + process(j);
    bank.push_back({0.0, prior * noise(j) / (prior + noise(j))});
    first_variance += bank.back().p / kModels;
  }
  const auto published = [&](Scalar& s, double z, int k) {
    for (Scalar& f : bank)
      if (k == 1) f.x = s.x;
    double greatest = -1e300;
    for (int j = 0; j < kModels; ++j) {
      const auto at = static_cast<std::size_t>(j);
      Scalar& f = bank[at];
      const double prior = f.p + process(j);
      const double c = prior + noise(j);
      const double innovation = z - f.x;
      log_weight[at] -= 0.5 * (innovation * innovation / c + std::log(c));
      greatest = std::max(greatest, log_weight[at]);
      f.x += prior / c * innovation;
      f.p = prior * (c - prior) / c;
    }
    double sum = 0.0;
    s = {0.0, 0.0};
    for (std::size_t j = 0; j < kModels; ++j) {
      log_weight[j] = std::max(log_weight[j] - greatest, -14.0);
      const double weight = std::exp(log_weight[j]);
      sum += weight;
      s.x += weight * bank[j].x;
    }
    s.x /= sum;
    // Magill's covariance of the mean: each filter's own and its distance from the mean.
    for (std::size_t j = 0; j < kModels; ++j) {
      const double apart = bank[j].x - s.x;
      s.p += std::exp(log_weight[j]) / sum * (bank[j].p + apart * apart);
    }
  };
  expect_equal("mmae", published, first_variance);
}

// The variance of the covariance that random weights estimate against what follows from the Dirichlet law: for
// independent innovations whose square has variance t^2, a plain window of n has t^2 / n, one draw
// t^2 E(sum w^2) = 2 t^2 / (n + 1), B draws t^2 (1/n + (2/(n+1) - 1/n) / B).

struct Spread {
  double mean = 0.0, variance = 0.0;
};

// Statistics of the estimated covariance over many independent windows of unit normal innovations.
Spread spread(const char* rule_name, const char* weights, int draws, int window) {
  ifog::FilterSettings settings;
  settings.rule = rule_name;
  settings.weights = weights;
  settings.draws = draws;
  settings.window = window;
  settings.floor = 0.0;
  settings.process_noise = settings.measurement_noise = 1.0;
  const auto rule = ifog::make_rule(settings);
  ifog::test::Noise normal(3);
  constexpr int kWindows = 40'000;
  double sum = 0.0, squares = 0.0;
  std::uint64_t sequence = 0;
  for (int w = 0; w < kWindows; ++w) {
    double c = 0.0;
    for (int i = 0; i < window; ++i) {
      const double innovation = normal();
      c = rule->innovation_covariance({0.0, 1.0, {&innovation, 1}, sequence++, 0});
    }
    sum += c;
    squares += c * c;
  }
  const double mean = sum / kWindows;
  return {mean, squares / kWindows - mean * mean};
}

TEST(RandomWeighting, HasTheVarianceThatFollowsFromTheWeights) {
  constexpr int kShort = 20;
  constexpr double n = kShort;
  constexpr double kTau2 = 2.0;  // variance of the square of a unit normal
  const double one_draw = 2 * kTau2 / (n + 1);
  const auto expect = [](const Spread& got, double variance) {
    EXPECT_NEAR(got.mean, 1.0, 5 * std::sqrt(variance / 40'000));
    EXPECT_NEAR(got.variance / variance, 1.0, 0.05);
  };
  expect(spread("iae", "kept", 1, kShort), kTau2 / n);
  expect(spread("irwe-akfg", "kept", 1, kShort), one_draw);
  expect(spread("irwe-akfg", "fresh", 1, kShort), one_draw);
  expect(spread("irwe-akfg", "kept", 4, kShort), kTau2 / n + (one_draw - kTau2 / n) / 4);
  expect(spread("irwe-akfg", "fresh", 4, kShort), kTau2 / n + (one_draw - kTau2 / n) / 4);
  // Uniform weights: sum w^2 has no closed mean; E u^2 / (n (E u)^2) = 4 / (3 n) is its limit, good to 1/n.
  expect(spread("irwe-akfg", "uniform", 1, kShort), kTau2 * 4 / (3 * n));
}

TEST(RandomWeighting, FloorIsCountedAndCanBeSwitchedOff) {
  ifog::FilterSettings settings;
  settings.window = 2;
  settings.measurement_noise = settings.process_noise = 1.0;
  for (const double floor : {0.01, 0.0}) {
    settings.floor = floor;
    const auto rule = ifog::make_rule(settings);
    const double tiny = 1e-6;
    double c = 0.0;
    for (std::uint64_t i = 0; i < 3; ++i) c = rule->innovation_covariance({0.5, 1.0, {&tiny, 1}, i, 0});
    EXPECT_EQ(rule->floor_hits(), floor > 0 ? 2U : 0U);
    EXPECT_NEAR(c, floor > 0 ? 0.51 : 1e-12, 1e-12);
  }
}

}  // namespace
