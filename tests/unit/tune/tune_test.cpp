// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/tune.h"
#include "filters/kalman/likelihood.h"
#include "filters/tune/spectrum.h"
#include "tests/unit/test.h"

namespace {

using ifog::Tuning;
using ifog::test::Noise;

Tuning tuned(const std::vector<double>& rate, double period, std::vector<std::string> states = {}) {
  const std::span<const double> axes[] = {rate};
  ifog::TuneOptions options;
  options.states = std::move(states);
  return ifog::tune(axes, period, options);
}

const ifog::TunedFigure& figure(const ifog::TunedModel& model, const std::string& name) {
  return *std::ranges::find_if(model.figures, [&](const auto& f) { return f.name == name; });
}

std::vector<double> random_walk(unsigned seed, std::size_t n, double q_step, double r, double level) {
  Noise noise(seed);
  std::vector<double> z;
  double x = level;
  for (std::size_t k = 0; k < n; ++k) {
    x += std::sqrt(q_step) * noise();
    z.push_back(x + std::sqrt(r) * noise());
  }
  return z;
}

TEST(Tune, RecoversQAndRWithinItsOwnErrors) {
  constexpr double kPeriod = 0.01, kR = 4e-12, kStep = 4e-15;
  int inside_q = 0, inside_r = 0;
  constexpr int kRuns = 40;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Tuning t = tuned(random_walk(seed, 4000, kStep, kR, 5e-5), kPeriod, {"random-walk"});
    const auto& q = figure(t.models[0], "process_noise");
    const auto& r = figure(t.models[0], "measurement_noise");
    ASSERT_TRUE(q.std_error && r.std_error) << seed;
    // ln q is nearly normal where q itself is skewed.
    if (std::abs(std::log(q.value * kPeriod / kStep)) < 1.96 * *q.std_error / q.value) ++inside_q;
    if (std::abs(r.value - kR) < 1.96 * *r.std_error) ++inside_r;
  }
  // 38 of 40 are expected; fewer than 34 happens by chance once in a hundred.
  EXPECT_GE(inside_q, 34);
  EXPECT_GE(inside_r, 34);
}

// One model for all axes: however loud each is, the walk over the noise is the same, and what is reported is of
// the mean of their variances. The likelihood is that of the data as they are: less by n ln s where they are
// scaled.
TEST(Tune, ALoudAxisDoesNotDrownTheOthers) {
  constexpr double kPeriod = 0.01, kR = 4e-12, kStep = 4e-15;
  constexpr std::size_t kLength = 4000;
  std::vector<std::vector<double>> axes;
  for (const unsigned seed : {71U, 72U, 73U})
    axes.push_back(random_walk(seed, kLength, seed == 73 ? 1e-3 * kStep : kStep, kR, 5e-5));
  const auto fit = [&] {
    const std::vector<std::span<const double>> views(axes.begin(), axes.end());
    ifog::TuneOptions options;
    options.states = {"random-walk"};
    return ifog::tune(views, kPeriod, options).models[0];
  };
  const ifog::TunedModel alike = fit();
  for (double& rate : axes[1]) rate *= 10.0;
  for (double& rate : axes[2]) rate *= 100.0;
  const ifog::TunedModel unlike = fit();
  const double larger = unlike.settings.measurement_noise / alike.settings.measurement_noise;
  EXPECT_NEAR(larger, (1.0 + 100.0 + 10'000.0) / 3.0, 0.05 * larger);
  EXPECT_NEAR(unlike.settings.process_noise / alike.settings.process_noise / larger, 1.0, 0.02);
  EXPECT_NEAR(unlike.log_likelihood, alike.log_likelihood - kLength * std::log(1000.0), 1.0);
}

// White noise alone: R is the sample variance and its error sqrt(2/n) R, known in closed form.
TEST(Tune, WhiteNoiseHasTheClosedFormErrorAndALevelAtRest) {
  Noise noise(7);
  constexpr std::size_t kN = 10000;
  std::vector<double> z;
  double sum = 0.0, square = 0.0;
  for (std::size_t k = 0; k < kN; ++k) {
    z.push_back(1e-6 * noise());
    sum += z.back();
    square += z.back() * z.back();
  }
  const double variance = (square - sum * sum / kN) / (kN - 1);
  const Tuning t = tuned(z, 0.005, {"random-walk"});
  const auto& r = figure(t.models[0], "measurement_noise");
  EXPECT_NEAR(r.value, variance, 1e-3 * variance);
  ASSERT_TRUE(r.std_error.has_value());
  EXPECT_NEAR(*r.std_error, std::sqrt(2.0 / kN) * variance, 0.05 * std::sqrt(2.0 / kN) * variance);
  EXPECT_LT(t.models[0].settings.process_noise * 0.005, 1e-6 * variance);
}

TEST(Tune, PicksTheModelThatMadeTheData) {
  // A second-order resonance under white noise and a resting level.
  Noise noise(3);
  std::vector<double> z;
  double y1 = 0.0, y2 = 0.0;
  for (int k = 0; k < 8000; ++k) {
    const double y = 1.6 * y1 - 0.8 * y2 + 1e-6 * noise();
    y2 = y1;
    y1 = y;
    z.push_back(3e-5 + y + 1e-6 * noise());
  }
  const Tuning t = tuned(z, 0.01,
                         {"random-walk", "random-walk + gauss-markov", "random-walk + ar(1)",
                          "random-walk + ar(2)", "random-walk + ar(3)"});
  EXPECT_EQ(t.models[0].settings.state, "random-walk + ar(2)");
  const auto& phi1 = figure(t.models[0], "phi_1");
  const auto& phi2 = figure(t.models[0], "phi_2");
  ASSERT_TRUE(phi1.std_error && phi2.std_error);
  EXPECT_NEAR(phi1.value, 1.6, 4.0 * *phi1.std_error);
  EXPECT_NEAR(phi2.value, -0.8, 4.0 * *phi2.std_error);
  EXPECT_LT(*phi1.std_error, 0.02);

  const Tuning plain = tuned(random_walk(11, 4000, 1e-15, 1e-12, 0.0), 0.01);
  EXPECT_EQ(plain.models[0].settings.state, "random-walk");
}

// A colour that dies within two samples on a slow level: the likelihood has an optimum in which the
// autoregression plays the level, and it is far below.
TEST(Tune, PicksTheOrderOfAFastColour) {
  int right = 0;
  constexpr int kRuns = 3;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    Noise noise(100 + seed);
    std::vector<double> z;
    double level = 0.0, colour = noise() / std::sqrt(0.75);
    for (int k = 0; k < 4000; ++k) {
      level += 1e-3 * noise();
      colour = 0.5 * colour + noise();
      z.push_back(1e-6 * (level + colour + 0.5 * noise()));
    }
    const Tuning t = tuned(z, 0.01,
                           {"random-walk", "random-walk + gauss-markov", "random-walk + ar(1)",
                            "random-walk + ar(2)", "random-walk + arma(3,2)"});
    if (t.models[0].settings.state == "random-walk + ar(1)") ++right;
    EXPECT_NE(t.models[0].settings.state, "random-walk + arma(3,2)") << seed;
    const auto one = std::ranges::find_if(
        t.models, [](const auto& m) { return m.settings.state == "random-walk + ar(1)"; });
    EXPECT_NEAR(figure(*one, "phi_1").value, 0.5, 0.1) << seed;
  }
  EXPECT_GE(right, 2);
}

// Held out: of white noise the chosen model's published rate has no more noise than the random walk's; and figures
// of white noise are known: 1/sqrt(m).
TEST(Tune, SaysWhatTheModelWillDo) {
  const Tuning t = tuned(random_walk(21, 20000, 0.0, 4e-12, 0.0), 0.01);
  const auto& chosen = t.models[t.chosen];
  ASSERT_TRUE(chosen.held_out.has_value());
  const ifog::RateFigures& before = chosen.held_out->before[0];
  EXPECT_NEAR(before.rms_radps, 2e-6, 5e-8);
  ASSERT_TRUE(before.adev_radps[0] && before.adev_radps[1]);
  EXPECT_NEAR(*before.adev_radps[0], 2e-6 / std::sqrt(10.0), 1e-7);
  EXPECT_NEAR(*before.adev_radps[1], 2e-7, 3e-8);
  EXPECT_FALSE(before.adev_radps[3].has_value());  // 100 s of which 100 s are held out
  EXPECT_LT(chosen.held_out->after[0].rms_radps, 0.1 * before.rms_radps);
  for (const auto& model : t.models) {
    ASSERT_TRUE(model.held_out.has_value());
    if (model.settings.state != "random-walk") continue;
    const ifog::RateFigures &mine = chosen.held_out->after[0], &walk = model.held_out->after[0];
    EXPECT_LE(mine.rms_radps, 1.05 * walk.rms_radps);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_TRUE(mine.adev_radps[i] && walk.adev_radps[i]);
      EXPECT_LE(*mine.adev_radps[i], 1.05 * *walk.adev_radps[i]);
    }
  }
}

// The closed form: contrasts of a random walk under white noise are independent in the cosine transform.
TEST(Tune, WhittlesLikelihoodOfARandomWalkIsExact) {
  const std::vector<double> walk = random_walk(4, 1500, 1e-3, 1.0, 0.3);
  const std::vector<std::vector<double>> axes{walk};
  const ifog::RecordSpectrum spectrum = ifog::spectrum_of(axes);
  ASSERT_EQ(spectrum.samples, 1500U);
  double cost = 0.0;
  const double n = 1500.0;
  // The transform written out, coefficient by coefficient.
  for (int k = 1; k < 1500; ++k) {
    double value = 0.0;
    for (int i = 0; i < 1500; ++i)
      value += walk[static_cast<std::size_t>(i)] * std::cos(M_PI * k * (i + 0.5) / n);
    const double square = 2.0 / n * value * value;
    const double expected = 1.0 + 1e-3 / (2.0 - 2.0 * std::cos(M_PI * k / n));
    cost += 0.5 * (std::log(2.0 * M_PI * expected) + square / expected);
    if (k < 64) {
      EXPECT_NEAR(spectrum.density[static_cast<std::size_t>(k - 1)], square, 1e-9 * (1.0 + square));
    }
  }
  const auto model = ifog::make_state_model("random-walk", {}, 0.01);
  const std::span<const double> alone[] = {walk};
  const double exact =
      ifog::likelihood(*model, 1e-3 / 0.01, 1.0, ifog::LikelihoodRecord(alone), 0.01).log_likelihood();
  // The diffuse likelihood is that of the contrasts but for a constant, ln sqrt(n).
  EXPECT_NEAR(-cost, exact + 0.5 * std::log(n), 1e-3);
}

TEST(Tune, FindsTheCorrelationTimeOfAGaussMarkovProcess) {
  Noise noise(5);
  constexpr double kPeriod = 0.1, kTau = 5.0;
  const double decay = std::exp(-kPeriod / kTau);
  std::vector<double> z;
  double y = 0.0;
  for (int k = 0; k < 40000; ++k) {
    y = decay * y + 2e-6 * std::sqrt(1.0 - decay * decay) * noise();
    z.push_back(-1e-5 + y + 3e-6 * noise());
  }
  const Tuning t = tuned(z, kPeriod, {"random-walk", "random-walk + gauss-markov"});
  ASSERT_EQ(t.models[0].settings.state, "random-walk + gauss-markov");
  const auto& tau = figure(t.models[0], "gauss_markov_correlation_time");
  ASSERT_TRUE(tau.std_error.has_value());
  EXPECT_NEAR(tau.value, kTau, 3.0 * *tau.std_error);
  EXPECT_LT(*tau.std_error, 0.2 * kTau);
}

TEST(Tune, RefusesWhatItCannotFit) {
  EXPECT_THROW(tuned(std::vector<double>(100, 1.0), 0.01), std::invalid_argument);
  EXPECT_THROW(tuned(std::vector<double>(1000, 1.0), 0.01), std::invalid_argument);
  EXPECT_THROW(tuned(random_walk(1, 1000, 1e-15, 1e-12, 0.0), 0.01, {"random-walk + arma(2,2)"}),
               std::invalid_argument);
}

}  // namespace
