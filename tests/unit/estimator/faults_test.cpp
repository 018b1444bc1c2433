// SPDX-License-Identifier: Apache-2.0
// Missing and bad measurements, uneven time, a stuck sensor, a covariance that breaks.
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Faults, AGapWidensTheVarianceByTheWalkOverTheWholeOfIt) {
  ifog::FilterSettings settings = told(1e-3);
  settings.rule = "ckf";
  settings.follow_manoeuvres = settings.conserve_angle = false;
  Fed filter(settings);
  const ifog::EstimatorOutput& out = filter.out;
  for (int i = 0; i < 3000; ++i)
    filter.step({static_cast<double>(i % 7)});  // a constant would be a stuck sensor
  const double before = out.variance_rad2ps2[0];
  filter.in.valid_axes = 0;
  filter.in.dt_s = 500 * kPeriod;
  filter.step({});
  EXPECT_NEAR(out.variance_rad2ps2[0], before + 500e-3, 1e-12);
  // One measurement: the gain and variance of (11) and (13), and half the noise when it is a mean over two
  // periods.
  const double prior = out.variance_rad2ps2[0] + 1e-3;
  filter.in.valid_axes = 1;
  filter.in.dt_s = kPeriod;
  filter.in.averaged_s = 2 * kPeriod;
  filter.step({3.0});
  EXPECT_NEAR(out.gain[0], prior / (prior + 0.5), 1e-12);
}

// A filter that cannot keep up gets several samples merged in one, step after step, and all through a turn.
TEST(Faults, MergedSamplesInATurnAreFollowed) {
  for (const int merged : {2, 3, 5, 9}) {
    const Record r =
        record(8, 40'000, 1e-3, [](int i) { return i < 8000 ? 0.0 : 300.0 * std::sin((i - 8000) * 1e-3); });
    Fed filter(told(1e-3));
    const ifog::EstimatorOutput& out = filter.out;
    double worst = 0.0;
    bool manoeuvre = false;
    for (int i = 0; i < 40'000;) {
      // By the plain mean of the samples, as the queue merges increments.
      const int n = i < 9000 ? 1 : std::min(merged, 40'000 - i);
      double measured = 0.0, truth = 0.0;
      for (int k = 0; k < n; ++k, ++i) {
        measured += r.measured[static_cast<std::size_t>(i)] / n;
        truth += r.truth[static_cast<std::size_t>(i)] / n;
      }
      filter.in.sequence = static_cast<std::uint64_t>(i);
      filter.in.dt_s = n * kPeriod;
      filter.step({measured});
      ASSERT_TRUE(std::isfinite(out.denoised_radps[0])) << merged << " merged, sample " << i;
      manoeuvre = manoeuvre || (out.flags & ifog::kManoeuvre) != 0;
      if (i > 10'000) worst = std::max(worst, std::abs(out.denoised_radps[0] - truth));
    }
    EXPECT_TRUE(manoeuvre);
    // In sigmas of one sample, of which the turn's is 300.
    EXPECT_LT(worst, 6.0) << merged << " merged";
  }
}

TEST(Faults, AStuckSensorIsFlaggedAndOnlyPredicted) {
  Fed filter(told(1e-3));
  const ifog::EstimatorOutput& out = filter.out;
  const Record r = record(6, 3001, 1e-3);
  for (int i = 0; i < 4000; ++i) {
    const double before = out.denoised_radps[0], variance = out.variance_rad2ps2[0];
    filter.in.stuck_axes = i > 3000 ? 1 : 0;
    filter.step({r.measured[static_cast<std::size_t>(std::min(i, 3000))]});
    EXPECT_EQ((out.flags & ifog::kStuck) != 0, i > 3000) << i;
    if (i <= 3001) continue;
    EXPECT_NEAR(out.denoised_radps[0], before, 0.01) << i;  // but for what is still owed
    EXPECT_GT(out.variance_rad2ps2[0], variance) << i;
  }
}

TEST(Faults, ABrokenCovarianceIsCountedAndTheFilterGoesOn) {
  const Record r = record(7, 20'000, 1e-3);
  ifog::FilterSettings settings = told(1e-3);
  settings.window = 2;  // without its floor the rule then meets covariances far below h'P-h
  settings.floor = 0.0;
  settings.follow_manoeuvres = false;
  const Filtered got = run(settings, r.measured);
  EXPECT_GT(got.health.divergences, 0U);
  for (const double rate : got.denoised) ASSERT_TRUE(std::isfinite(rate));
  settings.floor = 0.01;
  const Filtered floored = run(settings, r.measured);
  EXPECT_EQ(floored.health.divergences, 0U);
  EXPECT_GT(floored.health.floor_hits, 0U);
}

TEST(Faults, CovarianceStaysPositiveInALargeModelOverUnevenSteps) {
  ifog::FilterSettings settings;
  settings.state = "integrated-random-walk + ar(2) + harmonic + harmonic";
  settings.state_parameters = {1.6, -0.8, 1e-3, 4.17, 1e-2, 8.34, 1e-2};
  settings.process_noise = 1e-10;
  settings.measurement_noise = 1e-8;
  Fed filter(settings, 3);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 40'000; ++i) {
    filter.in.dt_s = kPeriod * (i % 97 == 0 ? 25.0 : 1.0 + 0.2 * std::sin(i));
    filter.in.valid_axes = static_cast<std::uint32_t>(random() % 16);
    ifog::Axes rates{};
    for (double& rate : rates) rate = 1e-4 * normal(random);
    const ifog::EstimatorOutput& out = filter.step(rates);
    for (const double variance : out.variance_rad2ps2) ASSERT_GT(variance, 0.0) << i;
    // Whatever the trackers make of the steps: the noise, and what is foreseen of it where nothing is
    // measured.
    for (std::size_t a = 0; a < 3; ++a)
      ASSERT_LT(std::abs(out.denoised_radps[a]), 12 * std::sqrt(out.variance_rad2ps2[a])) << i;
    for (const double rate : out.denoised_radps) ASSERT_LT(std::abs(rate), 0.05) << i;
  }
  EXPECT_EQ(filter.estimator.health().divergences, 0U);
}

TEST(Replay, GivesTheSameBits) {
  const Record r = record(10, 5000, 1e-3, [](int i) { return i > 3000 ? 9.0 : 0.0; });
  for (const char* weights : {"kept", "fresh", "uniform"}) {
    ifog::FilterSettings settings = told(1e-3);
    settings.weights = weights;
    EXPECT_EQ(run(settings, r.measured).denoised, run(settings, r.measured).denoised);
    ifog::FilterSettings other = settings;
    other.seed = 2;
    EXPECT_NE(run(settings, r.measured).denoised, run(other, r.measured).denoised);
  }
}

TEST(Health, GivesLagAndCorrelationOfASettledGain) {
  ifog::FilterSettings settings = told(1e-3);
  settings.rule = "ckf";
  const Filtered got = run(settings, record(11, 5000, 1e-3).measured);
  const double gain = (std::sqrt(1e-6 + 4e-3) - 1e-3) / 2;  // closed form of the Riccati equation
  EXPECT_NEAR(got.health.group_delay_s / (kPeriod * (1 - gain) / gain), 1.0, 1e-6);
  EXPECT_NEAR(got.health.correlation_time_s / (kPeriod / gain), 1.0, 1e-6);
  EXPECT_NEAR(got.health.nis_mean[0], 1.0, 0.3);
  EXPECT_NEAR(got.health.whiteness[0], 0.0, 0.2);
}

}  // namespace
