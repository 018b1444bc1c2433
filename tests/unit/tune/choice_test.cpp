// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/choice.h"
#include "filters/estimator/estimator.h"
#include "filters/kalman/likelihood.h"
#include "filters/state_models/state_model.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using ifog::test::kPeriod;
constexpr double kSigma = 1e-5;

struct Record {
  std::vector<double> rate, level;
};

Record walk_under_white_noise(unsigned seed, std::size_t samples, double ratio) {
  ifog::test::Noise normal(seed);
  Record out;
  double level = 3e-5;
  for (std::size_t k = 0; k < samples; ++k) {
    level += std::sqrt(ratio) * kSigma * normal();
    out.level.push_back(level);
    out.rate.push_back(level + kSigma * normal());
  }
  return out;
}

ifog::Tuning tuned(const std::vector<double>& rate, std::vector<std::string> states = {}) {
  const std::span<const double> axes[] = {rate};
  ifog::TuneOptions options;
  options.states = std::move(states);
  return ifog::tune(axes, kPeriod, options);
}

double rmse(const std::vector<double>& estimate, const std::vector<double>& level) {
  double sum = 0.0;
  for (std::size_t k = level.size() / 4; k < level.size(); ++k)
    sum += (estimate[k] - level[k]) * (estimate[k] - level[k]);
  return std::sqrt(sum);
}

// What is written is judged by the level, which only a simulation knows: on another record of the same gyro.
TEST(TuneChoice, AWalkIsNotTakenForColour) {
  constexpr double kRatio = 1e-3;
  for (unsigned seed = 5; seed <= 6; ++seed) {
    const auto fitted = walk_under_white_noise(seed, 6000, kRatio);
    const ifog::Tuning t = tuned(fitted.rate);
    const auto next = walk_under_white_noise(seed + 1000, 20000, kRatio);
    const double error = rmse(ifog::test::run(t.models[t.chosen].settings, next.rate).denoised, next.level);
    EXPECT_LE(error, 1.15 * rmse(ifog::test::told_the_truth(next.rate, kRatio), next.level))
        << seed << ": " << t.models[t.chosen].settings.state;
  }
}

ifog::TunedModel model_of(std::string state, std::vector<double> parameters, std::vector<double> ahead) {
  ifog::TunedModel model;
  model.settings.state = std::move(state);
  model.settings.state_parameters = std::move(parameters);
  model.held_out.emplace();
  model.held_out->ahead = {std::move(ahead)};
  return model;
}

TEST(TuneChoice, TheLikelihoodIsOverruledOnlyTowardsTheWalk) {
  const auto walk = model_of("random-walk", {}, {1.0, 0.5, 0.4});
  const auto quiet = model_of("random-walk + ar(1)", {0.9, 1.0}, {1.0, 0.4, 0.1});
  std::vector<ifog::TunedModel> walk_first{walk, quiet};
  EXPECT_EQ(ifog::choose(walk_first, kPeriod, 1e4), 0U);
  EXPECT_EQ(walk_first[0].passed_over, "");
  // Likelier than the walk and predicts no worse: chosen, whatever a third one predicts.
  const auto likelier = model_of("random-walk + ar(1)", {0.5, 1.0}, {1.2, 0.45, 0.3});
  std::vector<ifog::TunedModel> colour_first{likelier, quiet, walk};
  EXPECT_EQ(ifog::choose(colour_first, kPeriod, 1e4), 0U);
  // It does not follow: worse than the walk.
  const auto still = model_of("random-walk + ar(1)", {0.5, 1.0}, {1.0, 0.6, 0.8});
  std::vector<ifog::TunedModel> still_first{still, quiet, walk};
  EXPECT_EQ(ifog::choose(still_first, kPeriod, 1e4), 1U);
  EXPECT_NE(still_first[0].passed_over, "");
  // A tenth of the record long.
  const auto slow = model_of("random-walk + ar(1)", {0.999, 1.0}, {1.0, 0.4, 0.3});
  std::vector<ifog::TunedModel> slow_first{slow, walk};
  EXPECT_EQ(ifog::choose(slow_first, kPeriod, 1e4), 1U);
  EXPECT_NE(slow_first[0].passed_over, "");
}

// Closed forms.
TEST(TuneChoice, TheRecordOverTheMemoryOfTheNoise) {
  const auto memories = [](const std::string& state, std::vector<double> parameters) {
    ifog::FilterSettings settings;
    settings.state = state;
    settings.state_parameters = std::move(parameters);
    return ifog::memories_in_record(settings, kPeriod, 1e4);
  };
  EXPECT_EQ(memories("random-walk", {}), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(memories("random-walk + ar(1)", {0.99, 1.0}), 100.0, 1e-6);
  EXPECT_NEAR(memories("random-walk + ar(1)", {-0.99, 1.0}), 100.0, 1e-6);
  EXPECT_NEAR(memories("random-walk + gauss-markov", {0.5, 1.0}), 1e4 * -std::expm1(-kPeriod / 0.5), 1e-6);
  // Poles r exp(±iw).
  EXPECT_NEAR(memories("random-walk + ar(2)", {2.0 * 0.98 * std::cos(0.3), -0.98 * 0.98, 1.0}), 200.0, 1e-5);
}

// A record of white noise does not show that its level stands still.
TEST(TuneChoice, ARecordThatShowsNoWalkGetsTheOneItMightHide) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto record = walk_under_white_noise(seed, 5000, 0.0);
    const ifog::Tuning t = tuned(record.rate, {"random-walk"});
    const auto& walk = t.models[0].figures[0];
    ASSERT_EQ(walk.name, "process_noise");
    ASSERT_TRUE(walk.std_error.has_value()) << seed;
    EXPECT_EQ(walk.value, t.models[0].settings.process_noise);
    const auto model = ifog::make_state_model("random-walk", {}, kPeriod);
    const std::span<const double> axes[] = {record.rate};
    const auto at = [&](double q) {
      return ifog::likelihood(*model, q, t.models[0].settings.measurement_noise, ifog::LikelihoodRecord(axes),
                              kPeriod)
          .log_likelihood();
    };
    double best = -std::numeric_limits<double>::infinity();
    for (int halves = 0; halves < 60; ++halves) best = std::max(best, at(std::ldexp(walk.value, -halves)));
    if (!t.models[0].walk_is_bound) {
      EXPECT_LT(at(std::ldexp(walk.value, -60)), best - 0.5) << seed;
      continue;
    }
    EXPECT_EQ(*walk.std_error, walk.value);
    EXPECT_NEAR(at(walk.value), best - 0.5, 0.05) << seed;
    // The likelihood of a slower walk is no worse than that, of a quicker one it is.
    EXPECT_LT(at(2.0 * walk.value), best - 0.5) << seed;
    // A filter with these settings follows: no level that stood still for the record is held for an hour.
    EXPECT_GT(walk.value * kPeriod * 5000.0 * 5000.0, 0.1 * kSigma * kSigma) << seed;
  }
}

// White noise about a level that the filter knows: the mean of the next m samples misses it by R/m.
TEST(TuneChoice, WhatIsForetoldOfWhiteNoiseIsItsVarianceOverTheSamples) {
  const auto record = walk_under_white_noise(9, 200000, 0.0);
  ifog::FilterSettings settings;
  settings.process_noise = 1e-24;
  settings.measurement_noise = kSigma * kSigma;
  const std::span<const double> axes[] = {record.rate};
  const ifog::Outcome outcome = ifog::outcome_of(settings, axes, kPeriod, 100000);
  ASSERT_GE(outcome.ahead[0].size(), 5U);
  for (std::size_t h = 0; h < 5; ++h) {
    const double m = std::pow(4.0, static_cast<double>(h)), expected = kSigma * kSigma / m;
    EXPECT_NEAR(outcome.ahead[0][h], expected, 5.0 * std::sqrt(2.0 * m / 100000.0) * expected) << h;
  }
}

// A hole says nothing: what a filter makes of it is in no figure, and the rate after it is as the rate
// before.
TEST(TuneChoice, WhereNothingWasMeasuredNothingIsJudged) {
  auto record = walk_under_white_noise(5, 20000, 0.0);
  ifog::FilterSettings settings;
  settings.process_noise = 10.0 * kSigma * kSigma / kPeriod;
  settings.measurement_noise = kSigma * kSigma;
  const std::span<const double> axes[] = {record.rate};
  const ifog::Outcome whole = ifog::outcome_of(settings, axes, kPeriod, 10000);
  for (std::size_t k = 12000; k < 16000; ++k) record.rate[k] = std::nan("");
  const ifog::Outcome holed = ifog::outcome_of(settings, axes, kPeriod, 10000);
  EXPECT_NEAR(holed.after[0].rms_radps, whole.after[0].rms_radps, 0.1 * whole.after[0].rms_radps);
  EXPECT_NEAR(holed.ahead[0][0], whole.ahead[0][0], 0.1 * whole.ahead[0][0]);
}

}  // namespace
