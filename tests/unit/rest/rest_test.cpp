// SPDX-License-Identifier: Apache-2.0
// Motion that was put into a record is found where it is, and noise of every kind is not mistaken for it.
#include "filters/rest/rest.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "filters/diagnosis/diagnose.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"
#include "tools/simulate/noise.h"

namespace {

using ifog::Rest;
using ifog::simulate::NoiseLevels;

constexpr double kRate = 100.0;

Rest rest_of(const std::vector<double>& rate) {
  const std::vector<std::span<const double>> axes{rate};
  return ifog::find_rest(axes, {}, 1.0 / kRate);
}

bool at_rest(const Rest& rest, double from_s, double to_s) {
  for (const ifog::Stretch& part : rest.at_rest)
    if (static_cast<double>(part.begin) <= from_s * kRate && static_cast<double>(part.end) >= to_s * kRate)
      return true;
  return false;
}

TEST(Rest, NoiseOfAnyKindIsNoMotion) {
  for (const NoiseLevels& levels :
       {NoiseLevels{.N = 1e-6}, NoiseLevels{.B = 1e-6}, NoiseLevels{.K = 1e-6}, NoiseLevels{.N = 2e-3},
        NoiseLevels{.N = 1e-3, .K = 1e-3}, NoiseLevels{.N = 1e-6, .R = 1e-4}}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Rest rest = rest_of(ifog::simulate::noise(levels, kRate, 60000, seed));
      EXPECT_EQ(rest.resting(), 60000U) << "N " << levels.N << " B " << levels.B << " K " << levels.K;
      EXPECT_EQ(rest.slow_turns.count, 0U) << "N " << levels.N << " B " << levels.B << " K " << levels.K;
    }
  }
}

// A drift carries noise of a tenth of the converter's step past the level where every second sample is a step off.
TEST(Rest, ACoarseConverterIsNotShaken) {
  std::vector<double> rate = ifog::simulate::noise({.N = 0.1 * std::sqrt(1e-3)}, 1000.0, 100'000, 3);
  for (std::size_t i = 0; i < rate.size(); ++i)
    rate[i] = 1e-5 * std::round(rate[i] + 1e-5 * static_cast<double>(i));
  const Rest rest = ifog::find_rest(std::vector<std::span<const double>>{rate}, {}, 1e-3);
  EXPECT_EQ(rest.resting(), rate.size());
}

// White noise, and beyond `rest_s` motion of low frequencies.
Rest rest_of_motion(double rate_hz, double length_s, double rest_s, double motion_radps, double smoothing_s) {
  const auto samples = static_cast<std::size_t>(length_s * rate_hz);
  std::vector<double> rate = ifog::simulate::noise({.N = 1e-4}, rate_hz, samples, 5);
  const std::vector<double> force = ifog::simulate::noise({.N = 1.0}, 1.0, samples, 6);
  const double gain = 1.0 / std::max(1.0, smoothing_s * rate_hz), scale = std::sqrt((2.0 - gain) / gain);
  double moved = 0.0;
  for (auto i = static_cast<std::size_t>(rest_s * rate_hz); i < samples; ++i)
    rate[i] += motion_radps * scale * (moved += gain * (force[i] - moved));
  return ifog::find_rest(std::vector<std::span<const double>>{rate}, {}, 1.0 / rate_hz);
}

// The log of a flight, ten minutes with one on the ground: its quieter windows are no measure of the noise.
TEST(Rest, AFlightThatHardlyRestsIsNoNoise) {
  const Rest rest = rest_of_motion(kRate, 600.0, 60.0, 0.23, 0.1);
  EXPECT_TRUE(at_rest(rest, 0.0, 59.0));
  EXPECT_LT(rest.resting(), 7000U);
  EXPECT_THROW(ifog::require_rest(rest, 1.0 / kRate, 0.0), std::invalid_argument);
}

// A hand that sets a gyro down, cut a tenth of a second too early or too late (a Ferraris calibration).
TEST(Rest, MotionInTheFirstOrLastTenthOfASecondIsFound) {
  for (const std::size_t samples : {6000U, 6020U})
    for (const std::size_t at : {std::size_t{0}, samples - 10}) {
      std::vector<double> rate = ifog::simulate::noise({.N = 1e-4}, kRate, samples, 5);
      for (std::size_t i = at; i < at + 10; ++i) rate[i] += 2.0;
      const Rest rest = rest_of(rate);
      const double from_s = static_cast<double>(at) / kRate;
      EXPECT_FALSE(at_rest(rest, from_s, from_s + 0.1)) << samples << " " << at;
      EXPECT_GT(rest.resting(), samples - 200);
    }
}

TEST(Rest, WithoutRestThereIsNone) {
  EXPECT_EQ(rest_of_motion(200.0, 26.0, 0.0, 0.04, 0.1).resting(), 0U);  // a hand-held VMU931
  EXPECT_EQ(rest_of_motion(4.0, 48.0, 0.0, 0.37, 0.0).resting(), 0U);    // a robot fish: six windows
  EXPECT_EQ(rest_of_motion(4.0, 48.0, 48.0, 0.0, 0.0).resting(), 192U);
  EXPECT_EQ(rest_of_motion(4.0, 2.0, 2.0, 0.0, 0.0).resting(), 8U);      // less than a window
  EXPECT_EQ(rest_of_motion(64.0, 33.0, 2.5, 0.04, 0.03).resting(), 0U);  // a Roomba that starts after 2 s
}

// Vibration that ceases for eight seconds of a hundred.
TEST(Rest, AFewQuietSecondsAreNoRest) {
  for (const bool quiet_half : {false, true}) {
    auto rate = ifog::simulate::noise({.N = 1e-5}, kRate, 10000, 8);
    for (std::size_t i = quiet_half ? 5000 : 800; i < rate.size(); ++i) rate[i] *= 8.0;
    const Rest rest = rest_of(rate);
    EXPECT_EQ(rest.turned, 0U);
    EXPECT_NEAR(static_cast<double>(rest.resting()), quiet_half ? 5000.0 : 800.0, 51.0);
    if (quiet_half)
      EXPECT_NO_THROW(ifog::require_rest(rest, 1.0 / kRate, 0.0));
    else
      EXPECT_THROW(ifog::require_rest(rest, 1.0 / kRate, 0.0), std::invalid_argument);
  }
}

TEST(Rest, AStepOfTheBiasAndOutliersAreNoMotion) {
  auto rate = ifog::simulate::noise({.N = 1e-5}, kRate, 60000, 3);
  for (std::size_t i = 30000; i < rate.size(); ++i) rate[i] += 1e-4;
  for (std::size_t i = 500; i < rate.size(); i += 1700) rate[i] += 0.5;
  const Rest rest = rest_of(rate);
  EXPECT_EQ(rest.turned, 0U);
  EXPECT_LE(rest.shaken, 200U);
}

// Below what is surely a turn: 100 °/h for a minute, twice.
TEST(Rest, SlowTurnsStayInAndAreSaid) {
  auto rate = ifog::simulate::noise({.N = 1e-6}, kRate, 60000, 5);
  for (const std::size_t from : {10000U, 30000U})
    for (std::size_t i = from; i < from + 6000; ++i) rate[i] += 4.85e-4;
  const Rest rest = rest_of(rate);
  EXPECT_EQ(rest.resting(), 60000U);
  EXPECT_EQ(rest.slow_turns.count, 4U);
  EXPECT_NEAR(static_cast<double>(rest.slow_turns.first) / kRate, 100.0, 11.0);
  EXPECT_NEAR(rest.slow_turns.largest_radps, 4.85e-4, 2e-5);
  EXPECT_TRUE(
      ifog::test::has(ifog::slow_turns_in_words(rest, 1.0 / kRate, 0.0), "leaps by up to 100 °/h, 4 times"));
}

// Dwells of a table without a reference, a row in 16 s.
TEST(Rest, DwellsWithoutAReferenceAreSaid) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1e-6}, 1.0 / 16.0, 200, 6);
  const std::vector<std::span<const double>> axes{rate};
  EXPECT_EQ(ifog::find_rest(axes, {}, 16.0).slow_turns.count, 0U);
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] += 0.1 * static_cast<double>(i % 5);
  const Rest rest = ifog::find_rest(std::vector<std::span<const double>>{rate}, {}, 16.0);
  EXPECT_EQ(rest.slow_turns.count, 160U);
  EXPECT_FALSE(ifog::slow_turns_in_words(rest, 16.0, 0.0).empty());
}

TEST(Rest, ATurnAndAShakeAreFoundWhereTheyAre) {
  auto rate = ifog::simulate::noise({.N = 1e-5}, kRate, 60000, 4);
  for (std::size_t i = 10000; i < 10400; ++i) rate[i] += 0.3;  // 100 … 104 s
  for (std::size_t i = 40000; i < 41000; ++i)                  // 400 … 410 s
    rate[i] += 2e-3 * std::sin(2.0 * 3.14159265 * 7.0 * static_cast<double>(i) / kRate);
  const Rest rest = rest_of(rate);
  EXPECT_TRUE(at_rest(rest, 0.0, 99.0));
  EXPECT_TRUE(at_rest(rest, 105.5, 399.0));
  EXPECT_TRUE(at_rest(rest, 411.5, 600.0));
  EXPECT_EQ(rest.at_rest.size(), 3U);
  // What moved takes up to a second on either side with it.
  EXPECT_GE(static_cast<double>(rest.turned) / kRate, 4.0);
  EXPECT_LE(static_cast<double>(rest.turned) / kRate, 6.0);
  EXPECT_GE(static_cast<double>(rest.shaken) / kRate, 9.5);
  EXPECT_LE(static_cast<double>(rest.shaken) / kRate, 12.0);
  EXPECT_NE(ifog::in_words(rest, 1.0 / kRate, 0.0), "");
  EXPECT_NO_THROW(ifog::require_rest(rest, 1.0 / kRate, 0.0));
}

TEST(Rest, ASteadyTurnIsNoRest) {
  auto rate = ifog::simulate::noise({.N = 1e-5}, kRate, 60000, 5);
  for (std::size_t i = 10000; i < 22000; ++i) rate[i] += 0.2;  // two minutes
  const Rest rest = rest_of(rate);
  EXPECT_FALSE(at_rest(rest, 150.0, 170.0));
  EXPECT_NEAR(static_cast<double>(rest.turned) / kRate, 120.0, 3.0);
}

TEST(Rest, TheNoiseIsThatOfTheRest) {
  auto rate = ifog::simulate::noise({.N = 1e-5}, kRate, 60000, 6);
  for (std::size_t i = 10000; i < 10400; ++i) rate[i] += 0.3;
  const auto found = ifog::noise_coefficients(ifog::AngleSum(rate, rest_of(rate).at_rest), 1.0 / kRate);
  ASSERT_TRUE(found.N.present);
  EXPECT_NEAR(found.N.value, 1e-5, 4.0 * found.N.std_error);
  EXPECT_LT(found.N.std_error, 2e-7);
  EXPECT_FALSE(found.B.present);
  EXPECT_FALSE(found.K.present);
}

TEST(Rest, WhatTwoListsHaveInCommon) {
  const std::vector<ifog::Stretch> a{{0, 10}, {20, 30}}, b{{5, 22}, {25, 40}};
  EXPECT_EQ(ifog::common(a, b), (std::vector<ifog::Stretch>{{5, 10}, {20, 22}, {25, 30}}));
}

// The dwells of a rate table: nothing is seen of a turn within one, but the reference says at what rate it
// was.
TEST(Rest, ASlowRecordIsAtRestWhereItsReferenceIs) {
  constexpr double kPeriod_s = 16.0;
  std::vector<double> rate(300, 1e-5), reference(300, 7e-5);
  for (std::size_t i = 100; i < 140; ++i) reference[i] = 0.02;
  reference[200] = std::nan("");
  const std::vector<std::span<const double>> axes{rate}, references{reference};
  const Rest rest = ifog::find_rest(axes, references, kPeriod_s);
  EXPECT_EQ(rest.turned, 40U);
  ASSERT_EQ(rest.at_rest.size(), 2U);
  EXPECT_EQ(rest.at_rest[0].end, 100U);
  EXPECT_EQ(rest.at_rest[1].begin, 140U);
  EXPECT_NO_THROW(ifog::require_rest(rest, kPeriod_s, 0.0));
  EXPECT_EQ(ifog::find_rest(axes, {}, kPeriod_s).turned, 0U);
  for (std::size_t i = 0; i < reference.size(); ++i) reference[i] = 0.01 * static_cast<double>(i % 7);
  EXPECT_THROW(ifog::require_rest(ifog::find_rest(axes, references, kPeriod_s), kPeriod_s, 0.0),
               std::invalid_argument);
}

// A gyro that was turned by hand: no noise figure, no heading forecast, no model may come of it.
TEST(Rest, AHandTurnedGyroIsRefused) {
  const std::string path = IFOG_SHARED_DATA "/kvh1750_direct_imu_rate.csv.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs the measured capture " << path;
  const ifog::Capture capture = ifog::read_capture(path);
  const std::vector<std::span<const double>> axes(capture.rate_radps.begin(), capture.rate_radps.end());
  const Rest rest = ifog::find_rest(axes, {}, 1e-3);
  EXPECT_GT(rest.turned, 5000U);
  EXPECT_THROW(ifog::require_rest(rest, 1e-3, 0.0), std::invalid_argument);
  ifog::Record record;
  record.name = "hand-turned";
  record.time_s = capture.time_s;
  record.rate_radps = capture.rate_radps[0];
  EXPECT_TRUE(ifog::test::has(ifog::test::refusal([&] { (void)ifog::diagnose({record}, {}); }), "turned"));
}

}  // namespace
