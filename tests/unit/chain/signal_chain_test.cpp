// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/signal_chain.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/chain/one_axis.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

// After a shake of the first hundred samples, without their piece.
TEST(SignalChain, DuringStartUpTheCompensatedRateIsPublishedAndSaidSo) {
  ChainSettings unknown = settings(0.0, 0.0);
  unknown.start_up_s = 1.0;
  for (const double shake : {0.0, 5e-4}) {
    SignalChain chain(std::make_unique<ChainParts>(unknown));
    ChainOutput out;
    std::vector<Increment> all = increments(6000, 2);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i < 100) all[i].rate_radps[0] += i % 2 == 0 ? shake : -shake;
      chain.process(all[i], out);
      ASSERT_EQ((out.flags & kNoiseUnknown) != 0, i < (shake > 0.0 ? 4096 + 512 : 4096)) << i;
      if ((out.flags & kNoiseUnknown) == 0) continue;
      ASSERT_EQ(out.estimate.denoised_radps[0], out.compensated_radps[0]);
      ASSERT_GT(out.estimate.variance_rad2ps2[0], 0.0) << i;
      ASSERT_NEAR(out.estimate.variance_rad2ps2[0], 1e-8, i > (shake > 0.0 ? 3000 : 200) ? 0.3e-8 : 1.0) << i;
    }
    EXPECT_NEAR(chain.parts().filter().measurement_noise, 1e-8, 0.1e-8);
    EXPECT_LT(std::abs(out.estimate.denoised_radps[0] - 0.01), 5e-5);
  }
}

// A rate that was found from rounded times is as often a little below what it is meant to be as above.
TEST(SignalChain, TheStartUpIsAsLongWhereTheRateIsOffByTheRoundingOfTimes) {
  const std::vector<Increment> all = increments(4200, 2);
  for (const double off : {-1e-6, -1e-12, 0.0, 1e-12, 1e-6}) {
    ChainSettings unknown = settings(0.0, 0.0);
    unknown.start_up_s = 1.0;
    unknown.facts.nominal_rate_hz *= 1.0 + off;
    SignalChain chain(std::make_unique<ChainParts>(unknown));
    ChainOutput out;
    int unfiltered = 0;
    for (const Increment& increment : all) {
      chain.process(increment, out);
      unfiltered += (out.flags & kNoiseUnknown) != 0 ? 1 : 0;
    }
    EXPECT_EQ(unfiltered, 4096) << off;
  }
}

TEST(SignalChain, AWarmUpBeginsAtPowerUpWhicheverWayThatIsSaid) {
  auto model = std::make_shared<Model>();
  Effect warm_up;
  warm_up.form = "warm_up";
  warm_up.parameters = {{"coefficient", 2e-6, 0.0, "rad/s"}, {"time_constant_s", 40.0, 0.0, "s"}};
  model->effects = {warm_up};
  ChainSettings by_time = settings(), by_clock = settings(), before = settings();
  by_time.model = by_clock.model = before.model = model;
  // As exact as its nanoseconds: 25 s.
  by_time.since_power_up_s = 25.0;
  by_clock.powered_ns = 1'795'000'000'000'000'000;
  before.powered_ns = 1'795'000'100'000'000'000;
  SignalChain one(std::make_unique<ChainParts>(by_time)), other(std::make_unique<ChainParts>(by_clock)),
      none(std::make_unique<ChainParts>(before));
  EXPECT_TRUE(other.parts().left_out().empty());
  ChainOutput a, b, c;
  std::int64_t read_ns = *by_clock.powered_ns + 25'000'000'000;
  for (Increment increment : increments(500, 4)) {
    increment.read_ns = read_ns;
    read_ns += 1'000'000;
    one.process(increment, a);
    other.process(increment, b);
    none.process(increment, c);
    ASSERT_EQ(bits(a.compensated_radps[0]), bits(b.compensated_radps[0]));
    ASSERT_LT(a.compensated_radps[0], increment.rate_radps[0] - 1e-6);
    // A sample from before power-up is a recording's, and nobody knows when that was switched on.
    ASSERT_EQ(bits(c.compensated_radps[0]), bits(increment.rate_radps[0]));
  }
}

TEST(SignalChain, AModelOnAChannelTheSensorDoesNotHaveIsRefusedByName) {
  ChainSettings wrong = settings();
  wrong.channels = {"supply_V"};
  wrong.facts.frame_channels = wrong.facts.channels = 1;
  wrong.model = linear_in("temperature_degC", 25.0, {"coefficient", 1e-6, 1e-8, "rad/s/degC"});
  const std::string said = test::refusal([&] { const ChainParts parts(wrong); });
  EXPECT_TRUE(test::has(said, "temperature_degC"));
  EXPECT_TRUE(test::has(said, "it has: supply_V"));
}

TEST(SignalChain, NewPartsGoOnWithTheAngle) {
  const std::vector<Increment> all = increments(1000, 3);
  SignalChain swapped(std::make_unique<ChainParts>(settings())),
      plain(std::make_unique<ChainParts>(settings()));
  ChainOutput a, b;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 100 == 50) swapped.swap(std::make_unique<ChainParts>(settings(1e-9)));
    swapped.process(all[i], a);
    plain.process(all[i], b);
    ASSERT_EQ(bits(a.angle_rad[0]), bits(b.angle_rad[0])) << i;
    ASSERT_EQ((a.flags & kFilterReset) != 0, i == 0 || i % 100 == 50) << i;
  }
}

// An output filter correlates neighbours: one of three axes has noise of colour 0.5. No noise is given, and
// after four minutes each axis is denoised as with the true noise: the bound is twice the steady error of a
// Kalman filter given q and the noise's density at low frequency, sqrt(sqrt(q R)).
TEST(SignalChain, ColourOfOneAxisThatNobodyToldMakesNoAxisLouder) {
  ChainSettings unknown = settings(0.0, 0.0);
  unknown.facts.axes = 3;
  unknown.axes = {"x", "y", "z"};
  constexpr double kNoise = 1e-4, kRatio = 1e-6, kColour = 0.5;
  for (const unsigned seed : {1U, 2U}) {
    if (test::kSanitized && seed > 1) continue;
    SignalChain chain(std::make_unique<ChainParts>(unknown));
    test::Noise normal(seed);
    Axes walk{}, noise{}, squares{};
    Increment in;
    ChainOutput out;
    constexpr int kSamples = 240'000, kFrom = 120'000;
    for (int i = 0; i < kSamples; ++i) {
      in.sequence = static_cast<std::uint64_t>(i);
      in.dt_s = kPeriod_s;
      in.valid_axes = 7;
      for (std::size_t a = 0; a < 3; ++a) {
        const double colour = a == 0 ? kColour : 0.0;
        noise[a] = colour * noise[a] + std::sqrt(1.0 - colour * colour) * normal();
        walk[a] += std::sqrt(kRatio) * normal();
        in.rate_radps[a] = kNoise * (noise[a] + walk[a]);
        in.covered_s[a] = kPeriod_s;
        in.delta_theta_rad[a] = in.rate_radps[a] * kPeriod_s;
      }
      chain.process(in, out);
      for (std::size_t a = 0; a < 3 && i >= kFrom; ++a)
        squares[a] += std::pow(out.estimate.denoised_radps[a] / kNoise - walk[a], 2) / (kSamples - kFrom);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      const double density = a == 0 ? (1.0 + kColour) / (1.0 - kColour) : 1.0;
      EXPECT_LT(std::sqrt(squares[a]), 2.0 * std::sqrt(std::sqrt(kRatio * density)))
          << seed << ", axis " << a;
    }
  }
}

// ∫(denoised − compensated)dt over a turn with a sharp start and a slow end, with new parts at sample `at`.
double apart_after_a_turn(const ChainSettings& each, int at, unsigned seed) {
  SignalChain chain(std::make_unique<ChainParts>(each));
  Incrementer incrementer(each.facts);
  Increment increment;
  ChainOutput out;
  test::Noise noise(seed, 1e-4);
  double apart_rad = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const double t = i * kPeriod_s - 3.0;
    Reading reading;
    reading.sequence = static_cast<std::uint32_t>(i % 128);
    reading.has_sequence = true;
    reading.valid_axes = 1;
    reading.value[0] = noise() + (t < 0.0 ? 0.0 : 1.7 * (t < 0.5 ? 1.0 : std::exp((0.5 - t) / 0.4)));
    incrementer.next(reading, increment);
    if (i == at) chain.swap(std::make_unique<ChainParts>(each));
    chain.process(increment, out);
    apart_rad += (out.estimate.denoised_radps[0] - out.compensated_radps[0]) * kPeriod_s;
  }
  return apart_rad;
}

// What the old filter had fallen short of, the new one pays back. A filter that has learned how slow its
// sensor is lags by seconds, T, behind which noise alone turns by sigma sqrt(T dt), 3e-4 degrees here: what
// is lost is the mean of nine seeds.
TEST(SignalChain, NewPartsInATurnKeepTheDenoisedAngle) {
  for (const double q : {1e-10, 0.0})  // noise given, and learned again from the first 0.3 s
    for (const int at : {3'000, 3'010, 3'400}) {
      if (test::kSanitized && at > 3'010) continue;
      ChainSettings each = settings(q);
      each.start_up_s = 0.3;
      const int seeds = q > 0.0 ? 1 : 9;
      double apart_rad = 0.0;
      for (int seed = 0; seed < seeds; ++seed)
        apart_rad += apart_after_a_turn(each, at, static_cast<unsigned>(5 + seed)) / seeds;
      EXPECT_LT(std::abs(apart_rad), 0.001 * 3.14159265 / 180.0) << "reload at sample " << at << ", q " << q;
    }
}

}  // namespace
}  // namespace ifog
