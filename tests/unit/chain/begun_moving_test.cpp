// SPDX-License-Identifier: Apache-2.0
// A filter may begin anywhere in a motion, and must not take its beginning for one. The truth is the simulated one.
#include "filters/chain/signal_chain.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRandomWalk = 0.005 * kDegree / 60.0;  // rad/√s
// Over any so many samples the normalised error squared is on average less than that: of noise alone the mean
// of 64 squares is beyond 2.2 once in 10^7. A motion that begins slowly adds what is needed to notice it.
constexpr std::size_t kSamples = 64;
constexpr double kMost = 16.0;

double noise_of(double rate_hz) { return kRandomWalk * kRandomWalk * rate_hz; }

struct Course {
  std::vector<double> error;
  double worst = 0.0;  // mean of the normalised square over kSamples
  std::uint64_t manoeuvres = 0;
};

// told: the noise is configured. measured: adds to the truth of a sample's number what is no rotation.
Course run(
    double rate_hz, bool told, unsigned seed, std::size_t samples,
    const std::function<double(std::size_t)>& truth,
    const std::function<double(std::size_t)>& measured = [](std::size_t) { return 0.0; }) {
  ChainSettings settings;
  settings.facts.nominal_rate_hz = rate_hz;
  settings.axes = {""};
  if (told) {
    settings.filter.process_noise = 1e-16;
    settings.filter.measurement_noise = noise_of(rate_hz);
  }
  SignalChain chain(std::make_unique<ChainParts>(settings));
  test::Noise noise(seed, std::sqrt(noise_of(rate_hz)));
  Course out;
  std::vector<double> normalised;
  double sum = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    Increment in;
    in.sequence = i;
    in.samples = 1;
    in.valid_axes = 1;
    in.dt_s = in.covered_s[0] = 1.0 / rate_hz;
    in.rate_radps[0] = truth(i) + measured(i) + noise();
    in.delta_theta_rad[0] = in.rate_radps[0] * in.dt_s;
    ChainOutput published;
    chain.process(in, published);
    out.error.push_back(published.estimate.denoised_radps[0] - truth(i));
    normalised.push_back(std::pow(out.error.back(), 2) / published.estimate.variance_rad2ps2[0]);
    sum += normalised[i] - (i >= kSamples ? normalised[i - kSamples] : 0.0);
    out.worst = std::max(out.worst, sum / kSamples);
  }
  out.manoeuvres = chain.health().manoeuvres;
  return out;
}

// At rest a beginning is none of a motion.
TEST(BegunMoving, AtRestNothingIsTakenForAManoeuvre) {
  for (const bool told : {true, false})
    for (const double rate_hz : {10.0, 200.0})
      for (unsigned seed = 1; seed <= 200; ++seed)
        EXPECT_EQ(run(rate_hz, told, seed, 500, [](std::size_t) { return 1e-4; }).manoeuvres, 0U)
            << told << " " << rate_hz << " " << seed;
}

// Among the first samples, too.
TEST(BegunMoving, AJumpIsFollowedAndASingleOutlierPassedOver) {
  const double sigma = std::sqrt(noise_of(100.0));
  for (const std::size_t at : {24U, 40U, 60U, 100U})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const Course jump =
          run(100.0, true, seed, 300, [&](std::size_t i) { return i < at ? 0.0 : 20.0 * sigma; });
      for (std::size_t i = at + 10; i < jump.error.size(); ++i)
        ASSERT_LT(std::abs(jump.error[i]), 6.0 * sigma) << at << " " << seed << " " << i;
      EXPECT_LT(jump.worst, kMost) << at << " " << seed;
      const Course outlier = run(
          100.0, true, seed, 200 + at, [](std::size_t) { return 0.0; },
          [&](std::size_t i) { return i == at ? 50.0 * sigma : 0.0; });
      for (std::size_t i = at; i < outlier.error.size(); ++i)
        ASSERT_LT(std::abs(outlier.error[i]), 2.5 * sigma) << at << " " << seed << " " << i;
      EXPECT_EQ(outlier.manoeuvres, 0U) << at << " " << seed;
    }
}

}  // namespace
}  // namespace ifog
