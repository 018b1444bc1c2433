// SPDX-License-Identifier: Apache-2.0
// A stretch that was made louder or quieter is found where it is, as loud as it was made and at its
// frequencies; noise of every kind that stays the same is not said to change.
#include "filters/rest/noise_change.h"
#include "tests/unit/test.h"
#include "tools/simulate/noise.h"

namespace {

using ifog::NoiseChange;
using ifog::simulate::NoiseLevels;

constexpr double kRate_hz = 100.0;

std::vector<NoiseChange> changes_of(const std::vector<double>& rate) {
  const std::vector<ifog::Stretch> all{{0, rate.size()}};
  return ifog::noise_changes(rate, all, 1.0 / kRate_hz,
                             [](std::size_t i) { return static_cast<double>(i) / kRate_hz; });
}

std::vector<double> made_louder(std::vector<double> rate, double from_s, double to_s, double times) {
  for (auto i = static_cast<std::size_t>(from_s * kRate_hz); i < static_cast<std::size_t>(to_s * kRate_hz);
       ++i)
    rate[i] *= times;
  return rate;
}

TEST(NoiseChange, NoiseThatStaysTheSameHasNone) {
  for (const NoiseLevels& levels :
       {NoiseLevels{.N = 1e-5}, NoiseLevels{.B = 1e-5}, NoiseLevels{.K = 1e-5},
        NoiseLevels{.N = 1e-5, .B = 1e-6, .K = 1e-7}, NoiseLevels{.N = 1e-5, .R = 1e-6}})
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
      EXPECT_TRUE(changes_of(ifog::simulate::noise(levels, kRate_hz, 60'000, seed)).empty())
          << "N " << levels.N << " B " << levels.B << " K " << levels.K << " seed " << seed;
}

TEST(NoiseChange, OutliersAreNone) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1e-5}, kRate_hz, 60'000, 7);
  for (std::size_t i = 100; i < rate.size(); i += 4321) rate[i] += 0.1;
  EXPECT_TRUE(changes_of(rate).empty());
}

// Two stretches, each found next to the other, of 1800 s in 64 times.
TEST(NoiseChange, AQuietAndALoudStretchAreWhereTheyAreAndAsLoudAsTheyAre) {
  const std::vector<double> quiet =
      made_louder(ifog::simulate::noise({.N = 1e-5}, kRate_hz, 180'000, 3), 300.0, 750.0, 0.5);
  const std::vector<NoiseChange> found = changes_of(made_louder(quiet, 1606.0, 1713.0, 5.0));
  ASSERT_EQ(found.size(), 2U);
  constexpr double kTime_s = 1800.0 / 64.0;
  EXPECT_NEAR(found[0].times, 0.5, 0.1);
  EXPECT_NEAR(found[0].from_s, 300.0, kTime_s);
  EXPECT_NEAR(found[0].to_s, 750.0, kTime_s);
  EXPECT_NEAR(found[1].from_s, 1606.0, kTime_s);
  EXPECT_NEAR(found[1].to_s, 1713.0, kTime_s);
  EXPECT_NEAR(found[1].times, 5.0, 1.0);
  EXPECT_DOUBLE_EQ(found[1].range_hz.high, 0.5 * kRate_hz);
  EXPECT_TRUE(ifog::test::has(ifog::in_words(found), "times the noise in 16"));
}

// Sway of 0.05 to 0.5 Hz in white noise: the frequencies above stay as they are.
TEST(NoiseChange, OnlyTheFrequenciesThatChangedAreNamed) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1e-5}, kRate_hz, 180'000, 13);
  ifog::test::Noise normal(17);
  double sway = 0.0;
  for (std::size_t i = 60'000; i < 80'000; ++i) {
    sway += -0.01 * sway + 2e-5 * normal();
    rate[i] += sway;
  }
  const std::vector<NoiseChange> found = changes_of(rate);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].from_s, 600.0, 29.0);
  EXPECT_NEAR(found[0].to_s, 800.0, 29.0);
  EXPECT_LT(found[0].range_hz.high, 15.0);
  EXPECT_GT(found[0].times, 2.0);
}

// Nothing is known between two parts, and nothing is called quiet there.
TEST(NoiseChange, AHoleIsNone) {
  const std::vector<double> rate = ifog::simulate::noise({.N = 1e-5}, kRate_hz, 60'000, 19);
  const std::vector<ifog::Stretch> parts{{0, 20'000}, {45'000, 60'000}};
  EXPECT_TRUE(
      ifog::noise_changes(rate, parts, 0.01, [](std::size_t i) { return static_cast<double>(i); }).empty());
}

TEST(NoiseChange, OfTooLittleNothingIsSaid) {
  EXPECT_TRUE(changes_of({}).empty());
  EXPECT_TRUE(changes_of(std::vector<double>(50, 1e-5)).empty());
  EXPECT_TRUE(changes_of(std::vector<double>(5000, 0.0)).empty());
}

std::vector<double> white(std::size_t samples, unsigned seed, double mean, double deviation) {
  std::vector<double> rate = ifog::simulate::noise({.N = deviation}, 1.0, samples, seed);
  for (double& value : rate) value += mean;
  return rate;
}

// What a coarse sensor gives is mostly its last value.
TEST(NoiseChange, NoiseBelowTheSensorsStepStaysTheSame) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> level;
  for (const std::size_t samples : {6000UL, 60'000UL})
    for (const double steps : {0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4})
      for (unsigned seed = 1; seed <= (samples < 10'000 ? 24U : 4U); ++seed) {
        std::vector<double> rate = white(samples, seed, level(random), steps);
        for (double& value : rate) value = 1e-5 * std::round(value);
        const std::vector<NoiseChange> found = changes_of(rate);
        EXPECT_TRUE(found.empty()) << steps << ' ' << samples << ' ' << seed << ifog::in_words(found);
      }
}

// However little the rest moves.
TEST(NoiseChange, LoudnessIsNeverToldAgainstNothing) {
  std::vector<double> rate = white(60'000, 5, 0.0, 1e-5);
  for (std::size_t i = 30'000; i < rate.size(); ++i) rate[i] = 1e-300 * static_cast<double>(i % 2);
  for (const NoiseChange& change : changes_of(rate)) {
    EXPECT_LE(change.times, 1e6);
    EXPECT_GE(change.times, 1e-6);
  }
  EXPECT_FALSE(changes_of(rate).empty());
}

}  // namespace
