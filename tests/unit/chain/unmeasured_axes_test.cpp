// SPDX-License-Identifier: Apache-2.0
// What the chain makes of axes that are not measured: invalid samples, values that repeat, none at all.
#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "tests/unit/chain/one_axis.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

Increment without_value(Increment in) {
  in.valid_axes = 0;
  in.covered_s[0] = in.delta_theta_rad[0] = 0.0;
  in.rate_radps[0] = std::numeric_limits<double>::quiet_NaN();
  in.flags |= kInvalid;
  return in;
}

// Also of a filter that is begun with it: at start-up, by what was learned there, or by a reload.
TEST(SignalChain, AnAxisThatHasHadValuesKeepsOneOverAnInvalidSample) {
  for (const double noise : {0.0, 1e-8}) {
    ChainSettings with = settings(noise, noise);
    with.start_up_s = 1.0;
    SignalChain chain(std::make_unique<ChainParts>(with));
    ChainOutput out;
    const std::vector<Increment> all = increments(2500, 2);
    for (std::size_t i = 0; i < all.size(); ++i) {
      Increment in = all[i];
      if (i % 9 == 5 || (i > 990 && i < 1010) || (i >= 1800 && i < 1820)) in = without_value(in);
      if (i == 1800) static_cast<void>(chain.swap(std::make_unique<ChainParts>(with)));
      chain.process(in, out);
      ASSERT_NEAR(out.estimate.denoised_radps[0], 0.01, 1e-3) << noise << ", sample " << i;
      ASSERT_GE(out.estimate.variance_rad2ps2[0], 0.0) << noise << ", sample " << i;
    }
  }
}

// One in a hundred is lost on the way, or comes and cannot be used: what is learned of the noise is the same,
// and as much as of a sensor that loses none.
TEST(SignalChain, WhatIsLearnedAtRestIsTheSameWhetherSamplesAreLostOrInvalid) {
  const auto told_variance = [](bool lost, bool invalid) {
    ChainSettings learning = settings();
    learning.filter = FilterChoice{};
    learning.start_up_s = 1.0;
    SignalChain chain(std::make_unique<ChainParts>(learning));
    ChainOutput out;
    int missing = 0;
    double variance = 0.0;
    const std::vector<Increment> all = increments(50'000, 3);
    for (std::size_t i = 0; i < all.size(); ++i) {
      Increment in = all[i];
      if (i % 97 == 96 && (lost || invalid)) {
        if (lost) {
          ++missing;
          continue;
        }
        in = without_value(in);
      }
      if (missing > 0) {
        in.flags |= kGapBefore;
        in.dt_s += kPeriod_s * std::exchange(missing, 0);
      }
      chain.process(in, out);
      if (i >= 40'000) variance += out.estimate.variance_rad2ps2[0] / 10'000;
    }
    return variance;
  };
  const double whole = told_variance(false, false);
  EXPECT_NEAR(told_variance(true, false) / told_variance(false, true), 1.0, 0.05);
  EXPECT_LT(told_variance(true, false), 2.0 * whole);
}

// A logger that loses 30 samples in every 600: a stretch of noise goes on over the gaps, and a rate that is not zero is not
// clipped about zero after them.
TEST(SignalChain, TheNoiseIsLearnedOverGaps) {
  ChainSettings learning = settings();
  learning.filter = FilterChoice{};
  SignalChain chain(std::make_unique<ChainParts>(learning));
  ChainOutput out;
  const std::vector<Increment> all = increments(60'000, 4);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 600 >= 570) continue;
    Increment in = all[i];
    if (i > 0 && i % 600 == 0) {
      in.flags |= kGapBefore;
      in.dt_s += 30.0 * kPeriod_s;
    }
    chain.process(in, out);
  }
  EXPECT_TRUE(chain.parts().learned());
  EXPECT_NEAR(out.estimate.denoised_radps[0], 0.01, 2e-4);
}

// A correction by a live channel changes every compensated value. Repetition is judged by what the sensor
// sent: from the 101st repeat on, with and without a model, before and after the noise is known. The flag ends
// with the first different value.
TEST(SignalChain, AStuckSensorIsFlaggedBehindACorrectionThatIsAlive) {
  ChainSettings plain = settings();
  plain.channels = {"accel_x_mps2"};
  plain.channel_max_age_s = {0.0};
  plain.facts.frame_channels = plain.facts.channels = 1;
  ChainSettings with = plain, learning = plain;
  with.model = learning.model = linear_in("accel_x_mps2", 0.0, {"coefficient", 1e-6, 1e-8, "rad/s/(m/s^2)"});
  learning.filter = FilterChoice{};
  test::Noise normal(9);
  for (const SensorKind kind : {SensorKind::rate, SensorKind::delta_angle, SensorKind::angle})
    for (ChainSettings* const each : {&plain, &with, &learning}) {
      each->facts.kind = kind;
      SignalChain chain(std::make_unique<ChainParts>(*each));
      Incrementer incrementer(each->facts);
      Increment increment;
      ChainOutput out;
      int flagged = 0;
      for (int i = 0; i < 1900; ++i) {
        Reading reading;
        reading.sequence = static_cast<std::uint32_t>(i % 128);
        reading.has_sequence = true;
        // A device clock that trembles makes another rate of the same turn.
        reading.device_time_ns = std::int64_t{1'000'000} * i + (i % 7) * 1000;
        reading.valid_axes = 1;
        reading.fresh_channels = 1;
        reading.channel[0] = 0.1 * normal();
        const int at = i % 700;  // a fault returns
        const bool stands = i >= 400 && (at >= 400 || at < 300);
        const double scale = kind == SensorKind::rate ? 1.0 : kPeriod_s;
        reading.value[0] = scale * (stands ? 0.1 : 0.1 + 1e-4 * normal());
        incrementer.next(reading, increment);
        chain.process(increment, out);
        const bool stuck = (out.estimate.flags & kStuck) != 0;
        ASSERT_EQ(stuck, (i >= 500 && i < 1000) || (i >= 1200 && i < 1700)) << i;
        flagged += stuck ? 1 : 0;
      }
      EXPECT_EQ(flagged, 1000);
    }
}

// Three axes of which one is not as the others: until `dead_until` it has no value, or it repeats one.
ChainOutput of_three(int n, int dead_until, bool repeats, SignalChain& chain) {
  ChainSettings three = settings();
  three.facts.axes = 3;
  Incrementer incrementer(three.facts);
  Increment increment;
  ChainOutput out;
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0.01, 1e-4);
  for (int i = 0; i < n; ++i) {
    Reading reading;
    reading.sequence = static_cast<std::uint32_t>(i % 128);
    reading.has_sequence = true;
    reading.value = {normal(engine), repeats ? 0.0 : normal(engine), normal(engine)};
    reading.valid_axes = repeats || i >= dead_until ? 7 : 5;
    incrementer.next(reading, increment);
    chain.process(increment, out);
    const bool known = repeats || i >= dead_until;
    EXPECT_EQ(std::isfinite(out.estimate.denoised_radps[1]), known) << i;
    EXPECT_EQ(std::isfinite(out.estimate.variance_rad2ps2[1]), known) << i;
    EXPECT_TRUE(std::isfinite(out.estimate.denoised_radps[0] + out.estimate.variance_rad2ps2[2])) << i;
  }
  return out;
}

SignalChain chain_of_three(double q, double r) {
  ChainSettings three = settings(q, r);
  three.facts.axes = 3;
  three.axes = {"x", "y", "z"};
  three.start_up_s = 1.0;
  return SignalChain(std::make_unique<ChainParts>(three));
}

// Nothing is known of it, and 0 with a small variance would say that all is.
TEST(SignalChain, AnAxisThatHasHadNoValueHasNoEstimate) {
  for (const double q : {1e-10, 0.0}) {
    SignalChain chain = chain_of_three(q, 100.0 * q);
    of_three(3000, 3000, false, chain);
    SignalChain late = chain_of_three(q, 100.0 * q);
    const ChainOutput out = of_three(6000, 2500, false, late);
    EXPECT_NEAR(out.estimate.denoised_radps[1], 0.01, 1e-4);
  }
}

// The others' noise is what it is: an axis that repeats one value has none to share.
TEST(SignalChain, AStuckAxisMakesTheOthersNoQuieter) {
  SignalChain chain = chain_of_three(0.0, 0.0);
  of_three(6000, 0, true, chain);
  EXPECT_NEAR(chain.parts().filter().measurement_noise, 1e-8, 0.1e-8);
}

// A gyro of one axis in a format of three lacks nothing; one whose axis comes later did, from the beginning.
TEST(Incrementer, AnAxisThatHasNeverBeenThereIsNoInvalidSample) {
  SensorFacts facts;
  facts.axes = 3;
  facts.sequence_modulus = 128;
  facts.nominal_rate_hz = 100.0;
  Incrementer incrementer(facts);
  std::uint64_t n = 0;
  const auto feed = [&](std::uint32_t valid_axes, int samples) {
    Increment out;
    for (int i = 0; i < samples; ++i, ++n) {
      Reading reading;
      reading.has_sequence = true;
      reading.sequence = static_cast<std::uint32_t>(n % 128);
      reading.arrival_ns = 1'000'000'000 + static_cast<std::int64_t>(n) * 10'000'000;
      reading.valid_axes = valid_axes;
      reading.value = {0.01 + 1e-6 * static_cast<double>(n % 7), 0.02, 0.03};
      ASSERT_TRUE(incrementer.next(reading, out));
      EXPECT_EQ((out.flags & kInvalid) != 0, valid_axes == 0 || valid_axes == 5) << n;
    }
  };
  feed(0, 5);  // nothing at all
  EXPECT_EQ(incrementer.counts().invalid, 5U);
  feed(1, 100);
  EXPECT_EQ(incrementer.counts().invalid, 5U);
  EXPECT_EQ(incrementer.axes_seen(), 1U);
  feed(0, 3);  // the axis that it has
  EXPECT_EQ(incrementer.counts().invalid, 8U);
  feed(3, 10);  // a second one: it was missing in those hundred
  EXPECT_EQ(incrementer.counts().invalid, 108U);
  feed(7, 10);  // and the third in these ten
  EXPECT_EQ(incrementer.counts().invalid, 118U);
  feed(5, 4);
  EXPECT_EQ(incrementer.counts().invalid, 122U);
}

// Axes whose noise is 1 : 3 : 10, under a model that says so and where nobody does: each is published with
// the variance of its own error.

constexpr double kPeriod = 0.01;
constexpr Axes kSigma{1e-5, 3e-5, 1e-4};
// Variance of the walk, a sample.
constexpr Axes kWalkAsNoise{1e-15, 9e-15, 1e-13}, kWalkAlike{1e-14, 1e-14, 1e-14},
    kWalkAgainst{1e-12, 1e-13, 1e-14};
const std::vector<std::string> kNames{"x", "y", "z"};

ChainSettings unlike(bool known, const Axes& walk) {
  ChainSettings out;
  out.facts.axes = 3;
  out.facts.nominal_rate_hz = 1.0 / kPeriod;
  out.axes = kNames;
  if (!known) return out;
  Model model;
  model.filter.emplace();
  for (std::size_t a = 0; a < 3; ++a) {
    model.noise[kNames[a]].N = kSigma[a] * std::sqrt(kPeriod);
    model.noise[kNames[a]].K = std::sqrt(walk[a] / kPeriod);
    model.filter->measurement_noise += kSigma[a] * kSigma[a] / 3.0;
    model.filter->process_noise += walk[a] / kPeriod / 3.0;
  }
  out.model = std::make_shared<const Model>(model);
  return out;
}

// Mean of error^2 over the variance of each axis from sample `from` to `to`, over seeds.
Axes normalised(const ChainSettings& settings, const Axes& steps, int from, int to, unsigned seeds) {
  Axes sums{};
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    test::Noise normal(seed);
    SignalChain chain(std::make_unique<ChainParts>(settings));
    Increment in;
    ChainOutput out;
    Axes walk{};
    for (int i = 0; i < to; ++i) {
      in.sequence = static_cast<std::uint64_t>(i);
      in.dt_s = kPeriod;
      in.valid_axes = 7;
      in.samples = 1;
      for (std::size_t a = 0; a < 3; ++a) {
        walk[a] += std::sqrt(steps[a]) * normal();
        in.rate_radps[a] = walk[a] + kSigma[a] * normal();
        in.covered_s[a] = kPeriod;
      }
      chain.process(in, out);
      if (i < from) continue;
      for (std::size_t a = 0; a < 3; ++a)
        sums[a] += std::pow(out.estimate.denoised_radps[a] - walk[a], 2) / out.estimate.variance_rad2ps2[a] /
                   (to - from) / seeds;
    }
  }
  return sums;
}

// Settled and before the noise has been measured. Without a model, what the first seconds say of each axis' part of the
// walk is forgotten with what they said of the walk.
TEST(UnlikeAxesOfAChain, HaveTheirOwnVariance) {
  struct Row {
    const char* name;
    bool known;
    Axes walk;
    int from, to;
    unsigned seeds;
    double low, high;
  };
  for (const Row& row :
       {Row{"a model, settled", true, kWalkAsNoise, 2000, 20'000, 8, 0.6, 1.4},
        Row{"a model, first samples", true, kWalkAsNoise, 5, 50, 60, 0.4, 1.6},
        Row{"a model, walks alike", true, kWalkAlike, 15'000, 60'000, 4, 0.3, 1.6},
        Row{"a model, walks against the noise", true, kWalkAgainst, 15'000, 60'000, 4, 0.3, 1.6},
        Row{"no model", false, kWalkAsNoise, 12'000, 30'000, 8, 0.6, 1.4}}) {
    SCOPED_TRACE(row.name);
    const Axes squares = normalised(unlike(row.known, row.walk), row.walk, row.from, row.to, row.seeds);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GT(squares[a], row.low) << kNames[a];
      EXPECT_LT(squares[a], row.high) << kNames[a];
    }
  }
}

}  // namespace
}  // namespace ifog
