// SPDX-License-Identifier: Apache-2.0
// The delay of a reference that was logged late is estimated to a part of a sample and corrected.
#include "filters/diagnosis/cleaning/cross_delay.h"
#include "filters/diagnosis/cleaning/steps.h"
#include "filters/diagnosis/diagnose.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kStep_s = 0.05;
constexpr std::size_t kSamples = 12000;

// A table that swings and is turned now and then; band-limited to some 1.5 Hz. rad/s.
double turning(double t) {
  double rate = 0.3 * std::sin(0.21 * t + 0.4) + 0.1 * std::sin(1.7 * t) + 0.02 * std::sin(6.3 * t + 1.0);
  for (const double at : {60.0, 210.0, 333.3, 470.7})
    rate += 0.2 * std::exp(-0.5 * std::pow((t - at) / 0.8, 2));
  return rate;
}

// An arm that a motor turns to and fro (compute_relative_angle_between_two_IMUs), rad/s.
double swinging(double t) {
  t += 1e-3 * (std::sin(0.7 * t) + std::sin(1.9 * t));
  return 0.1 * std::sin(3.0 * t) + 0.025 * std::sin(9.0 * t + 1.0);
}

struct Logged {
  std::vector<double> time, rate, reference, temperature;
  Record record;

  // The reference of a time is the true rate delay_s before it.
  Logged(std::uint64_t seed, double delay_s, const std::function<double(double)>& truth = turning,
         double scale_factor = 0.0) {
    test::Noise normal(seed);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double t = kStep_s * static_cast<double>(i);
      time.push_back(t);
      temperature.push_back(25.0 + 8.0 * std::sin(t / 90.0));
      rate.push_back(truth(t) * (1.0 + scale_factor * (temperature.back() - 25.0)) + 2e-3 + 1e-3 * normal());
      reference.push_back(truth(t - delay_s) + 1e-4 * normal());
    }
    record.name = "logged";
    record.time_s = time;
    record.rate_radps = rate;
    record.reference_radps = reference;
    record.channels = {{"temperature_degC", temperature}};
  }
  Logged(const Logged&) = delete;
  Logged& operator=(const Logged&) = delete;
};

// The true rate itself is the oracle: no interpolation, a function of time. Of a motion that repeats the nearest delay is
// taken. Every second axis is reversed.
TEST(ReferenceDelay, IsFoundToAPartOfASampleAndShifted) {
  double sign = 1.0;
  for (const double delay_s : {0.31, -0.137, 3.705, 0.012, -21.6, 0.11, 0.09}) {
    const auto truth = delay_s == 0.11 || delay_s == 0.09 ? swinging : turning;
    Logged logged(7, delay_s, truth);
    for (double& each : logged.rate) each *= sign;
    sign = -sign;
    const OwnedRecords aligned = align_references(std::vector{logged.record});
    ASSERT_EQ(aligned.delays.size(), 1U) << delay_s;
    EXPECT_NEAR(aligned.delays[0].delay_s, delay_s, 4.0 * aligned.delays[0].std_error_s) << delay_s;
    EXPECT_LT(aligned.delays[0].std_error_s, 1e-3);
    const auto margin = static_cast<std::size_t>(std::ceil(std::abs(delay_s) / kStep_s)) + 1;
    for (std::size_t i = margin; i + margin < kSamples; ++i)
      ASSERT_NEAR(aligned.records[0].reference_radps[i], truth(logged.time[i]), 6e-4) << delay_s << ' ' << i;
    // Where the reference was not yet, or no longer, logged there is none.
    EXPECT_TRUE(std::isnan(aligned.records[0].reference_radps[delay_s > 0.0 ? kSamples - 1 : 0]));
  }
}

// Two loggers whose crystals differ: at the end the reference is 0.3 s later than at first.
TEST(ReferenceDelay, GrowsIfTheClocksRunApart) {
  constexpr double kGrowth = 5e-4;
  const double end_s = kStep_s * static_cast<double>(kSamples);
  for (const double start_s : {0.4, -0.15}) {
    Logged logged(8, 0.0);
    test::Noise normal(9);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double t = logged.time[i];
      logged.reference[i] = turning(t - start_s - kGrowth * t) + 1e-4 * normal();
    }
    const OwnedRecords aligned = align_references(std::vector{logged.record});
    ASSERT_EQ(aligned.remarks.size(), 1U);
    EXPECT_TRUE(test::has(aligned.remarks[0], " ppm faster than that of the rate")) << aligned.remarks[0];
    const auto margin = static_cast<std::size_t>((std::abs(start_s) + kGrowth * end_s) / kStep_s) + 2;
    for (std::size_t i = margin; i + margin < kSamples; ++i)
      ASSERT_NEAR(aligned.records[0].reference_radps[i], turning(logged.time[i]), 2e-3)
          << start_s << ' ' << i;
  }
}

// Noise that grows with the frequency, as of a reference differentiated from angles, hides the motion from a filter
// that whitens the rate, and is smoothed by a shift of half a sample, which a fit takes for a better one.
TEST(ReferenceDelay, IsFoundWithAReferenceDifferentiatedFromNoisyAngles) {
  const auto quick = [](double t) { return turning(t) + 0.3 * std::sin(9.1 * t) * std::sin(0.9 * t); };
  for (const double delay_s : {0.62, -0.43, 0.0}) {
    Logged logged(8, delay_s, quick);
    test::Noise normal(9);
    double before = 0.0;
    for (double& each : logged.reference) {
      const double angle = 2e-3 * normal();
      each += (angle - std::exchange(before, angle)) / kStep_s;
    }
    const OwnedRecords aligned = align_references(std::vector{logged.record});
    ASSERT_EQ(aligned.delays.size(), delay_s == 0.0 ? 0U : 1U) << delay_s;
    if (delay_s != 0.0) {
      EXPECT_NEAR(aligned.delays[0].delay_s, delay_s, 4.0 * aligned.delays[0].std_error_s) << delay_s;
      EXPECT_LT(aligned.delays[0].std_error_s, 0.03 * kStep_s);
    }
  }
}

// Errors of the delay over its standard error: of unit variance, also where the reference is noisier than the rate and
// samples are missing.
TEST(ReferenceDelay, StandardErrorIsHonest) {
  double square = 0.0;
  constexpr int kSeeds = 60;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Logged logged(100 + static_cast<std::uint64_t>(seed), 0.113);
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; seed % 2 == 1 && i < kSamples; ++i) {
      logged.reference[i] = random() % 50 == 0 ? std::nan("") : logged.reference[i] + 5e-3 * normal(random);
      if (random() % 50 == 0) logged.rate[i] = std::nan("");
    }
    const OwnedRecords aligned = align_references(std::vector{logged.record});
    ASSERT_EQ(aligned.delays.size(), 1U);
    square += std::pow((aligned.delays[0].delay_s - 0.113) / aligned.delays[0].std_error_s, 2);
  }
  // Chi-square of 60 degrees of freedom over 60: 99.9 % between 0.52 and 1.66.
  EXPECT_GT(square / kSeeds, 0.52);
  EXPECT_LT(square / kSeeds, 1.66);
}

TEST(ReferenceDelay, WhatIsNotLateIsLeftAsItIs) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Logged in_time(200 + seed, 0.0);
    EXPECT_TRUE(align_references(std::vector{in_time.record}).delays.empty()) << seed;
    const Logged with_effect(300 + seed, 0.0, turning, 3e-4);
    EXPECT_TRUE(align_references(std::vector{with_effect.record}).delays.empty()) << seed;
    // A table that hardly moves tells nothing, however late its reference is.
    const Logged resting(400 + seed, 2.0, [](double) { return 7e-5; });
    const OwnedRecords left = align_references(std::vector{resting.record});
    EXPECT_TRUE(left.delays.empty()) << seed;
    EXPECT_EQ(left.records[0].reference_radps.data(), resting.reference.data());
  }
}

TEST(ReferenceDelay, TheDiagnosisIsThatOfTheShiftedReference) {
  const Logged logged(11, 0.31, turning, 3e-4);
  const Diagnosis diagnosis = diagnose({logged.record}, {});
  ASSERT_EQ(diagnosis.reference_delays.size(), 1U);
  ASSERT_FALSE(diagnosis.effects.empty());
  for (const FoundEffect& found : diagnosis.effects)
    if (found.effect.form != "bias") {
      EXPECT_EQ(found.effect.form, "product") << found.effect.form;
    }
  // Noise of 1e-3 a sample, and nothing of the 0.03 rad/s that the delay had put there.
  EXPECT_LT(diagnosis.after.at("residual_rms_radps"), 1.1e-3);
}

TEST(ReferenceDelay, AJumpDisturbsTheInterpolationOfTwoSamplesOnEitherSide) {
  std::vector<double> jumping(40, 1.0);
  std::fill(jumping.begin() + 20, jumping.end(), 2.0);
  jumping[5] = std::nan("");
  const Samples moved = shifted(jumping, -3.4);
  for (std::size_t i = 4; i < 40; ++i) {
    if (i == 8 || i == 9 || (i > 21 && i < 25)) continue;
    EXPECT_NEAR(moved[i], i < 23 ? 1.0 : 2.0, 1e-12) << i;
  }
  EXPECT_TRUE(std::isnan(moved[8]) && std::isnan(moved[9]));
}

// A table that goes from level to level at once, or as fast as its motor can: its jumps and corners are all
// that tells a delay.
TEST(ReferenceDelay, IsToldWhereAllMotionIsJumps) {
  for (const double ramp_s : {0.0, 0.5}) {
    const auto level = [](double at) {
      return 0.2 * (static_cast<double>(static_cast<int>(at) * 7 % 5) - 2.0);
    };
    const auto stepping = [&](double t) {
      const double at = std::max(t, 0.0) / 20.0,
                   share = ramp_s > 0.0 ? (at - std::floor(at)) * 20.0 / ramp_s : 1.0;
      return at < 1.0 ? level(at) : level(at - 1.0) + std::min(1.0, share) * (level(at) - level(at - 1.0));
    };
    const Logged logged(24, 0.5, stepping);
    const OwnedRecords aligned = align_references(std::vector{logged.record});
    ASSERT_EQ(aligned.delays.size(), 1U) << ramp_s;
    EXPECT_NEAR(aligned.delays[0].delay_s, 0.5, kStep_s) << ramp_s << ", of a step no more can be told";
  }
}

}  // namespace
}  // namespace ifog
