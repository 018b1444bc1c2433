// SPDX-License-Identifier: Apache-2.0
// The rest detector, and the noise that is learned while it says so.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "filters/chain/signal_chain.h"
#include "filters/estimator/estimator.h"
#include "filters/estimator/rest_noise.h"

namespace ifog {
namespace {

constexpr double kPeriod_s = 0.005;
constexpr double kSigma_radps = 1e-5;

FilterSettings told(double ratio) {
  FilterSettings settings;
  settings.measurement_noise = kSigma_radps * kSigma_radps;
  settings.process_noise = ratio * settings.measurement_noise / kPeriod_s;
  return settings;
}

// Share of the samples from `from` on that are flagged, of a sensor that moves so, σ.
template <class Motion>
double share_at_rest(const FilterSettings& settings, int from, int samples, const Motion& motion) {
  std::mt19937_64 engine(20261122);
  std::normal_distribution<double> noise(0.0, kSigma_radps);
  Estimator estimator(settings, 1, kPeriod_s);
  EstimatorInput in;
  EstimatorOutput out;
  in.dt_s = kPeriod_s;
  in.valid_axes = 1;
  int flagged = 0;
  for (int i = 0; i < samples; ++i) {
    in.sequence = static_cast<std::uint64_t>(i);
    in.rate_radps[0] = kSigma_radps * motion(i) + noise(engine);
    estimator.step(in, out);
    if (i >= from && (out.flags & kAtRest) != 0) ++flagged;
  }
  return static_cast<double>(flagged) / (samples - from);
}

TEST(AtRest, IsSaidOfASensorThatRestsAndOfNoneThatMoves) {
  for (const double ratio : {1e-3, 1e-6}) {
    const FilterSettings settings = told(ratio);
    EXPECT_GT(share_at_rest(settings, 200, 100'000, [](int) { return 7.0; }), 0.999) << ratio;
    const auto swing = [](int i) {
      return i < 20'000 ? 0.0 : 30.0 * std::sin(2.0 * std::numbers::pi * 0.1 * kPeriod_s * (i - 20'000));
    };
    EXPECT_LT(share_at_rest(settings, 20'000, 100'000, swing), 0.02) << ratio;
    // A turn as quick as a hand's, from its second sample on and for a while after its end.
    const auto turn = [](int i) { return i < 20'000 || i >= 21'000 ? 0.0 : 1e4; };
    EXPECT_EQ(share_at_rest(settings, 20'001, 21'064, turn), 0.0) << ratio;
  }
}

// Quicker than any bias: somebody turns it, however evenly.
TEST(AtRest, IsNotSaidOfAnEvenTurn) {
  EXPECT_EQ(share_at_rest(told(1e-6), 0, 20'000, [](int) { return 0.021 / kSigma_radps; }), 0.0);
  EXPECT_GT(share_at_rest(told(1e-6), 200, 20'000, [](int) { return 0.019 / kSigma_radps; }), 0.99);
}

TEST(AtRest, IsNotSaidBeforeTheNoiseIsKnownNorWithoutADetector) {
  EXPECT_EQ(share_at_rest(told(1e-3), 0, 60, [](int) { return 0.0; }), 0.0);
  FilterSettings settings = told(1e-3);
  settings.follow_manoeuvres = false;
  EXPECT_EQ(share_at_rest(settings, 0, 10'000, [](int) { return 0.0; }), 0.0);
}

class Walk {
 public:
  Walk(double ratio, unsigned seed) : engine_(seed), step_(std::sqrt(ratio)) {}
  double next() {
    level_ += step_ * normal_(engine_);
    return level_ + normal_(engine_);
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  double step_, level_ = 0.0;
};

// The last news of so many samples of such a walk.
std::optional<NoiseEstimate> learn(RestNoise& learner, double ratio, int samples, unsigned seed,
                                   RestSample is = RestSample::kRest) {
  Walk walk(ratio, seed);
  std::optional<NoiseEstimate> last;
  for (int i = 0; i < samples; ++i) {
    learner.take({walk.next()}, 1, is);
    if (const auto news = learner.take_news(1.0)) last = news;
  }
  return last;
}

TEST(RestNoise, FindsTheWalkThatMadeTheRecord) {
  for (const double ratio : {1e-2, 1e-4, 1e-6}) {
    RestNoise learner;
    const auto found = learn(learner, ratio, 200'000, 3);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->measurement_noise, 1.0, 0.03) << ratio;
    EXPECT_NEAR(std::log10(found->process_noise / ratio), 0.0, 0.25) << ratio;
  }
}

// A few hundred samples say something, a few thousand a good deal: no walk that is there is missed for that.
TEST(RestNoise, BoundsTheWalkEarly) {
  constexpr int kSeeds = 5;
  double still = 0.0, walking = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    RestNoise of_still, of_walking;
    EXPECT_TRUE(learn(of_still, 1e-9, 600, 40 + seed));
    const auto more = learn(of_still, 1e-9, 2000, 50 + seed), walk = learn(of_walking, 1e-3, 2600, 60 + seed);
    ASSERT_TRUE(more && walk);
    still += std::log10(more->process_noise) / kSeeds;
    walking += std::log10(walk->process_noise) / kSeeds;
  }
  EXPECT_LT(still, -3.5);
  EXPECT_NEAR(walking, -3.0, 0.3);
}

TEST(RestNoise, LearnsNothingUnderWayOrFromWhatIsPassedOver) {
  for (const RestSample is : {RestSample::kMotion, RestSample::kPassedOver}) {
    RestNoise learner;
    EXPECT_FALSE(learn(learner, 1e-4, 20'000, 4, is));
    EXPECT_EQ(learner.known().samples, 0.0);
  }
}

TEST(RestNoise, GoesOnFromWhatItWasToldToRecall) {
  RestNoise first;
  (void)learn(first, 1e-6, 400'000, 5);
  RestNoise second;
  second.recall(first.known());
  // A hundredth of a record could not show that walk by itself: the slowest it can show is 6e-8.
  const auto found = learn(second, 1e-6, 6'000, 6);
  ASSERT_TRUE(found);
  EXPECT_NEAR(std::log10(found->process_noise / 1e-6), 0.0, 0.25);
  EXPECT_EQ(second.known().samples, first.known().samples + 4096.0);
}

TEST(RestNoise, ForgetsASensorThatWasAnotherOne) {
  RestNoise first;
  (void)learn(first, 1e-8, 400'000, 7);
  RestNoise second;
  second.recall(first.known());
  const auto before = learn(second, 1e-3, 60 * 4096, 8);
  ASSERT_TRUE(before);
  EXPECT_LT(before->process_noise, 1e-5);
  RestNoise third;
  third.recall(first.known());
  const auto after = learn(third, 1e-3, 80 * 4096, 8);
  ASSERT_TRUE(after);
  EXPECT_NEAR(std::log10(after->process_noise / 1e-3), 0.0, 0.25);
}

// Corrected otherwise than before: a bound from the first news on, the sums begin anew, and what is surely
// quicker than the bound is believed.
TEST(RestNoise, WhatOtherCorrectionsLeftIsABound) {
  RestNoise first;
  (void)learn(first, 1e-7, 1'000'000, 31);
  for (const double ratio : {1e-10, 1e-3}) {
    RestNoise second;
    second.recall_bound(first.known());
    const auto early = learn(second, ratio, 1000, 32);
    ASSERT_TRUE(early);
    EXPECT_LT(early->process_noise, 3e-7) << ratio;
    const auto late = learn(second, ratio, 80 * 4096, 33);
    ASSERT_TRUE(late);
    EXPECT_LT(second.known().samples, 400'000.0);
    if (ratio < 1e-7)
      EXPECT_LT(late->process_noise, 1e-8);
    else
      EXPECT_NEAR(std::log10(late->process_noise / ratio), 0.0, 0.25);
  }
}

// A swing that passes for rest: blocks that began in it reach into what comes after it, at the octaves that
// tell a slow walk.
TEST(RestNoise, ForgetsABeginningThatWasAMotion) {
  double found = 0.0;
  constexpr int kSeeds = 5, kSwing = 6000;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    RestNoise learner;
    Walk noise(0.0, seed);
    for (int i = 0; i < kSwing; ++i)
      learner.take({noise.next() + 4.0 * std::sin(2.0 * std::numbers::pi * (kSwing - i) / 10'000.0)}, 1,
                   RestSample::kRest);
    const auto after = learn(learner, 1e-6, 16 * 4096, 20 + seed);
    ASSERT_TRUE(after);
    found += std::log10(after->process_noise / 1e-6) / kSeeds;
  }
  EXPECT_NEAR(found, 0.0, 0.3);
}

ChainSettings untold() {
  ChainSettings settings;
  settings.facts.nominal_rate_hz = 1.0 / kPeriod_s;
  settings.axes = {""};
  return settings;
}

// Runs the chain over noise of that walk; gives the first output.
ChainOutput run(SignalChain& chain, double ratio, int samples, unsigned seed) {
  Walk walk(ratio, seed);
  Increment in;
  ChainOutput out, first;
  in.dt_s = kPeriod_s;
  in.valid_axes = 1;
  for (int i = 0; i < samples; ++i) {
    in.sequence = static_cast<std::uint64_t>(i);
    in.rate_radps[0] = kSigma_radps * walk.next();
    in.covered_s[0] = kPeriod_s;
    in.delta_theta_rad[0] = in.rate_radps[0] * kPeriod_s;
    chain.process(in, out);
    if (i == 0) first = out;
  }
  return first;
}

// Of noise correlated by 0.5 means over many samples are 3 times as loud as one of white noise. The best gain
// for that and the walk leaves sqrt(3 Q R); the one that takes it for white, with the walk known, 1.15 times
// that.
TEST(LearnedNoise, TheGainIsForWhatLongMeansHave) {
  constexpr double kRatio = 1e-4, kCorrelation = 0.5;
  constexpr int kSeeds = 4, kSettled = 20'000, kLength = 80'000;
  double square = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SignalChain chain(std::make_unique<ChainParts>(untold()));
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    Increment in;
    ChainOutput out;
    in.dt_s = in.covered_s[0] = kPeriod_s;
    in.valid_axes = 1;
    double level = 0.0, noise = 0.0;
    for (int i = 0; i < kLength; ++i) {
      in.sequence = static_cast<std::uint64_t>(i);
      level += std::sqrt(kRatio) * normal(engine);
      noise = kCorrelation * noise + std::sqrt(1.0 - kCorrelation * kCorrelation) * normal(engine);
      in.rate_radps[0] = kSigma_radps * (level + noise);
      in.delta_theta_rad[0] = in.rate_radps[0] * kPeriod_s;
      chain.process(in, out);
      if (i < kSettled) continue;
      const double error = out.estimate.denoised_radps[0] / kSigma_radps - level;
      square += error * error / (kSeeds * (kLength - kSettled));
    }
    const double density = kRatio * kSigma_radps * kSigma_radps / kPeriod_s;
    EXPECT_NEAR(std::log10(chain.parts().filter().process_noise / density), 0.0, 0.3) << seed;
  }
  EXPECT_LT(square / std::sqrt(3.0 * kRatio), 1.1);
}

TEST(LearnedNoise, TakesThePlaceOfAStartUp) {
  SignalChain first(std::make_unique<ChainParts>(untold()));
  EXPECT_NE(run(first, 1e-6, 100'000, 9).flags & kNoiseUnknown, 0U);
  const auto learned = first.parts().learned();
  ASSERT_TRUE(learned);
  ChainSettings settings = untold();
  settings.learned = learned;
  SignalChain second(std::make_unique<ChainParts>(settings));
  EXPECT_TRUE(second.parts().noise_known());
  EXPECT_EQ(run(second, 1e-6, 1, 10).flags & kNoiseUnknown, 0U);
  const double density = 1e-6 * kSigma_radps * kSigma_radps / kPeriod_s;
  EXPECT_NEAR(std::log10(second.parts().filter().process_noise / density), 0.0, 0.5);
  EXPECT_NEAR(second.parts().filter().measurement_noise / (kSigma_radps * kSigma_radps), 1.0, 0.05);
}

// Ten minutes after a model has come that corrects the walk the sensor is as quiet as it is now; with the
// same model a walk that seldom shows stays known. What is kept says which model was in.
TEST(LearnedNoise, GivesWayWhereTheModelHasChanged) {
  constexpr double kWalk = 1e-7, kCorrected = 1e-10;
  RestNoise before;
  (void)learn(before, kWalk, 2'000'000, 34);
  LearnedNoise learned{.process_noise = kWalk * kSigma_radps * kSigma_radps / kPeriod_s,
                       .measurement_noise = kSigma_radps * kSigma_radps,
                       .octaves = before.known(),
                       .model = {}};
  for (double& square : learned.octaves.squares) square *= kSigma_radps * kSigma_radps;
  ChainSettings settings = untold();
  auto model = std::make_shared<Model>();
  model->sensor = "corrected";
  settings.model = model;
  std::array<double, 2> found{};
  for (const bool same : {true, false}) {
    learned.set_model(same ? model->identity() : "");
    settings.learned = learned;
    SignalChain chain(std::make_unique<ChainParts>(settings));
    EXPECT_TRUE(chain.parts().learned()->is_of(same ? model->identity() : ""));
    (void)run(chain, kCorrected, 120'000, 35);
    found[same ? 0 : 1] = chain.parts().filter().process_noise * kPeriod_s / (kSigma_radps * kSigma_radps);
    EXPECT_TRUE(chain.parts().learned()->is_of(model->identity()));
  }
  EXPECT_GT(found[0], 3e-8);
  EXPECT_LT(found[1], 3e-9);
}

TEST(LearnedNoise, StandsBehindWhatIsTold) {
  ChainSettings settings = untold();
  settings.learned =
      LearnedNoise{.process_noise = 1.0, .measurement_noise = 2.0, .colour = {}, .octaves = {}, .model = {}};
  auto model = std::make_shared<Model>();
  model->filter = told(1e-6);
  settings.model = model;
  const ChainParts of_model(settings);
  EXPECT_EQ(of_model.filter().process_noise, model->filter->process_noise);
  EXPECT_EQ(of_model.filter().measurement_noise, model->filter->measurement_noise);
  settings.model = nullptr;
  settings.filter.measurement_noise = 3.0;
  const ChainParts of_settings(settings);
  EXPECT_EQ(of_settings.filter().measurement_noise, 3.0);
  EXPECT_EQ(of_settings.filter().process_noise, 1.0);
  SignalChain chain(std::make_unique<ChainParts>(settings));
  settings.model = model;
  SignalChain with_model(std::make_unique<ChainParts>(settings));
  (void)run(with_model, 1e-6, 20'000, 11);
  EXPECT_FALSE(with_model.parts().learned()) << "a model's figures are not learned over";
}

// A start in a turn leaves a driving noise a million times too large: the sensor must be found at rest all
// the same, or it would never be put right.
TEST(LearnedNoise, AStartInATurnIsPutRight) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    ChainSettings settings = untold();
    SignalChain chain(std::make_unique<ChainParts>(settings));
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> noise(0.0, kSigma_radps);
    Increment in;
    ChainOutput out;
    in.dt_s = in.covered_s[0] = kPeriod_s;
    in.valid_axes = 1;
    for (int i = 0; i < 40'000; ++i) {
      in.sequence = static_cast<std::uint64_t>(i);
      in.rate_radps[0] = noise(engine) + 1.7 * std::exp(-0.01 * std::max(0, i - 700));
      in.delta_theta_rad[0] = in.rate_radps[0] * kPeriod_s;
      chain.process(in, out);
    }
    EXPECT_NE(out.estimate.flags & kAtRest, 0U) << seed;
    EXPECT_LT(chain.parts().filter().process_noise * kPeriod_s, 1e-5 * kSigma_radps * kSigma_radps) << seed;
  }
}

}  // namespace
}  // namespace ifog
