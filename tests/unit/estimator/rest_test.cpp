// SPDX-License-Identifier: Apache-2.0
// The rest detector, and the noise that is learned while it says so.
#include "filters/chain/signal_chain.h"
#include "filters/estimator/estimator.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

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
  test::Noise noise(20261122, kSigma_radps);
  test::Fed filter(settings, 1, kPeriod_s);
  int flagged = 0;
  for (int i = 0; i < samples; ++i) {
    const EstimatorOutput& out = filter.step({kSigma_radps * motion(i) + noise()});
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

class WalkInNoise {
 public:
  WalkInNoise(double ratio, unsigned seed) : engine_(seed), step_(std::sqrt(ratio)) {}
  double next() {
    level_ += step_ * normal_(engine_);
    return level_ + normal_(engine_);
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  double step_, level_ = 0.0;
};

ChainSettings untold() {
  ChainSettings settings;
  settings.facts.nominal_rate_hz = 1.0 / kPeriod_s;
  settings.axes = {""};
  return settings;
}

// Runs the chain over noise of that walk; gives the first output.
ChainOutput run(SignalChain& chain, double ratio, int samples, unsigned seed) {
  WalkInNoise walk(ratio, seed);
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

TEST(LearnedNoise, StandsBehindWhatIsTold) {
  ChainSettings settings = untold();
  settings.learned = LearnedNoise{
      .process_noise = 1.0, .measurement_noise = 2.0, .noise = {2.0}, .samples = 1e6, .model = {}};
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
  EXPECT_NEAR(of_settings.filter().process_noise, std::min(1.0 / 2.0 * 3.0, 1e9), 1e-9);
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
    test::Noise noise(seed, kSigma_radps);
    Increment in;
    ChainOutput out;
    in.dt_s = in.covered_s[0] = kPeriod_s;
    in.valid_axes = 1;
    for (int i = 0; i < 40'000; ++i) {
      in.sequence = static_cast<std::uint64_t>(i);
      in.rate_radps[0] = noise() + 1.7 * std::exp(-0.01 * std::max(0, i - 700));
      in.delta_theta_rad[0] = in.rate_radps[0] * kPeriod_s;
      chain.process(in, out);
    }
    EXPECT_NE(out.estimate.flags & kAtRest, 0U) << seed;
    EXPECT_LT(chain.parts().filter().process_noise * kPeriod_s, 1e-4 * kSigma_radps * kSigma_radps) << seed;
  }
}

// A vehicle in stop and go: no rest is as long as a stretch of noise, all together are.
TEST(LearnedNoise, RestsBetweenMotionsAddUp) {
  ChainSettings settings = untold();
  SignalChain chain(std::make_unique<ChainParts>(settings));
  test::Noise noise(4, kSigma_radps);
  Increment in;
  ChainOutput out;
  in.dt_s = in.covered_s[0] = kPeriod_s;
  in.valid_axes = 1;
  double square = 0.0, count = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    const int of_cycle = i % 3000;  // the last 1000 samples of each are a turn
    const double turn = of_cycle < 2000 ? 0.0 : std::pow(std::sin(M_PI * (of_cycle - 2000) / 1000.0), 2);
    in.sequence = static_cast<std::uint64_t>(i);
    in.rate_radps[0] = noise() + 300.0 * kSigma_radps * turn;
    in.delta_theta_rad[0] = in.rate_radps[0] * kPeriod_s;
    chain.process(in, out);
    if (i < 30'000 || of_cycle < 1000 || of_cycle >= 2000) continue;
    square += std::pow(out.estimate.denoised_radps[0] / kSigma_radps, 2);
    count += 1.0;
  }
  EXPECT_NEAR(chain.parts().filter().measurement_noise, kSigma_radps * kSigma_radps,
              0.1 * kSigma_radps * kSigma_radps);
  EXPECT_LT(square / count, 0.01);
}

}  // namespace
}  // namespace ifog
