// SPDX-License-Identifier: Apache-2.0
// What is late, lost, out of turn or begun anew, told from each other: of a device whose truth is known.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "filters/chain/incrementer.h"
#include "tests/unit/chain/sent_times.h"

namespace ifog {
namespace {

constexpr double kRate_hz = 100.0;
constexpr double kNominal_s = 0.01;

enum class Tells { nothing, counter, counter_and_clock };

struct Sent {
  std::uint64_t number;
  double arrives_s;
  double device_s;
  std::uint32_t sequence;
};

struct Got {
  IncrementerCounts counts;
  double angle_rad = 0.0, dt_s = 0.0, covered_s = 0.0;
  std::uint64_t clock_steps = 0;
  bool backwards = false;      // a label before the one before it
  double worst_label_s = 0.0;  // of the last second, against when the sample was taken
};

SensorFacts facts_of(Tells tells, std::uint32_t modulus) {
  SensorFacts facts;
  facts.nominal_rate_hz = kRate_hz;
  facts.sequence_modulus = tells == Tells::nothing ? 0 : modulus;
  return facts;
}

std::vector<Sent> on_time(std::uint64_t samples, std::uint32_t modulus = 128) {
  std::vector<Sent> out;
  for (std::uint64_t n = 0; n < samples; ++n) {
    const double at = static_cast<double>(n) * kNominal_s;
    const double jitter_s = 1e-4 * static_cast<double>(n * 7919 % 101) / 101.0;
    out.push_back({n, at + jitter_s, at, static_cast<std::uint32_t>(n % modulus)});
  }
  return out;
}

// All that comes from `begin` to `end` comes at `end`, in order.
void hold(std::vector<Sent>& frames, double begin_s, double end_s) {
  for (Sent& frame : frames)
    if (frame.arrives_s >= begin_s && frame.arrives_s < end_s) frame.arrives_s = end_s;
}
void lose(std::vector<Sent>& frames, std::uint64_t first, std::uint64_t count) {
  std::erase_if(frames,
                [&](const Sent& frame) { return frame.number >= first && frame.number < first + count; });
}

Got run(const std::vector<Sent>& frames, Tells tells, std::uint32_t modulus = 128, bool recorded = false,
        std::int64_t wrap_ns = 0) {
  Incrementer incrementer(facts_of(tells, modulus));
  Got got;
  Increment increment;
  std::int64_t last_ns = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Sent& frame = frames[i];
    Reading reading;
    reading.arrival_ns = kStart_ns + std::llround(frame.arrives_s * 1e9);
    reading.arrival_recorded = recorded;
    reading.valid_axes = 1;
    reading.value[0] = kTurning;
    reading.has_sequence = tells != Tells::nothing;
    reading.sequence = frame.sequence;
    if (tells == Tells::counter_and_clock) reading.device_time_ns = std::llround(frame.device_s * 1e9);
    reading.device_wrap_ns = wrap_ns;
    if (!incrementer.next(reading, increment)) continue;
    got.angle_rad += increment.delta_theta_rad[0];
    got.dt_s += increment.dt_s;
    got.covered_s += increment.covered_s[0];
    got.clock_steps += (increment.flags & kClockStep) != 0 ? 1 : 0;
    got.backwards = got.backwards || increment.utime_ns < last_ns;
    last_ns = increment.utime_ns;
    if (i + 100 >= frames.size())
      got.worst_label_s = std::max(
          got.worst_label_s, std::abs(static_cast<double>(increment.utime_ns - reading.arrival_ns) * 1e-9));
  }
  got.counts = incrementer.counts();
  return got;
}

class Counting : public testing::TestWithParam<Tells> {};
INSTANTIATE_TEST_SUITE_P(Devices, Counting, testing::Values(Tells::counter, Tells::counter_and_clock));

class HeldUp : public testing::TestWithParam<Tells> {};
INSTANTIATE_TEST_SUITE_P(Devices, HeldUp,
                         testing::Values(Tells::nothing, Tells::counter, Tells::counter_and_clock));

TEST_P(HeldUp, WhatComesLateAndAtOnceIsNotMissing) {
  for (const double held_s : {0.3, 0.5, 1.28, 1.3, 2.5, 2.56, 3.0, 10.0}) {
    std::vector<Sent> frames = on_time(3000);
    hold(frames, 7.0, 7.0 + held_s);
    const Got got = run(frames, GetParam());
    EXPECT_EQ(got.counts.missing, 0U) << held_s;
    EXPECT_EQ(got.counts.gaps, 0U) << held_s;
    EXPECT_NEAR(got.angle_rad, 3000 * kNominal_s * kTurning, 1e-4 * kTurning) << held_s;
    EXPECT_NEAR(got.dt_s, 3000 * kNominal_s, 1e-4) << held_s;
    EXPECT_FALSE(got.backwards) << held_s;
    EXPECT_LT(got.worst_label_s, 2e-3) << held_s;
  }
}

// A serial line carries little more than the sensor sends: what was held up comes a little faster than it was
// taken.
TEST_P(Counting, WhatDrainsSlowlyIsNotMissing) {
  for (const double faster : {1.05, 1.3, 3.0}) {
    for (const double held_s : {1.1, 1.28, 2.0, 2.5, 5.0}) {
      std::vector<Sent> frames = on_time(20000);
      double free_s = 0.0;  // of the line
      for (Sent& frame : frames) {
        const double from_s =
            frame.arrives_s >= 70.0 ? std::max(frame.arrives_s, 70.0 + held_s) : frame.arrives_s;
        free_s = std::max(from_s, free_s + kNominal_s / faster);
        // By an adapter that collects for 16 ms.
        frame.arrives_s = std::ceil(free_s / 0.016) * 0.016;
      }
      const Got got = run(frames, GetParam());
      EXPECT_EQ(got.counts.missing, 0U) << faster << ' ' << held_s;
      EXPECT_NEAR(got.angle_rad, 20000 * kNominal_s * kTurning, 1e-4 * kTurning);
      EXPECT_EQ(got.clock_steps, 0U) << faster << ' ' << held_s;
    }
  }
}

TEST_P(HeldUp, WhatWasLostIsCounted) {
  for (const std::uint64_t lost : {50U, 127U, 128U, 129U, 200U, 256U, 1280U}) {
    if (GetParam() == Tells::counter && lost == 128) continue;  // one round of the counter: may be late
    std::vector<Sent> frames = on_time(4000);
    lose(frames, 1000, lost);
    const Got got = run(frames, GetParam());
    EXPECT_NEAR(static_cast<double>(got.counts.missing), static_cast<double>(lost),
                GetParam() == Tells::nothing ? 1.0 : 0.0);
    EXPECT_EQ(got.counts.gaps, 1U) << lost;
    EXPECT_NEAR(got.dt_s, 4000 * kNominal_s, 2e-2) << lost;
    EXPECT_NEAR(got.covered_s, static_cast<double>(4000 - lost) * kNominal_s, 1e-3) << lost;
    EXPECT_FALSE(got.backwards) << lost;
    EXPECT_LT(got.worst_label_s, 2e-3) << lost;
  }
}

// A device with neither counter nor clock cannot tell.
TEST_P(Counting, WhatIsLostOfWhatWasHeldUpIsCounted) {
  std::vector<Sent> frames = on_time(3000);
  hold(frames, 7.0, 10.0);
  lose(frames, 800, 40);
  const Got got = run(frames, GetParam());
  EXPECT_EQ(got.counts.missing, 40U);
  EXPECT_NEAR(got.dt_s, 3000 * kNominal_s, 1e-4);
}

TEST_P(Counting, OfTwoThatChangePlacesOneIsLeftOutAndNoRoundIsMade) {
  for (const bool wraps : {false, true}) {
    std::vector<Sent> frames = on_time(3000);
    for (std::size_t i = 100; i < 3000; i += 100) {
      std::swap(frames[i], frames[i + 1]);
      std::swap(frames[i].arrives_s, frames[i + 1].arrives_s);
    }
    // A clock of 32 bits in microseconds that goes round meanwhile.
    constexpr std::int64_t kRound_ns = 4'294'967'296'000;
    if (wraps)
      for (Sent& frame : frames) frame.device_s = std::fmod(frame.device_s + 4280.0, 1e-9 * kRound_ns);
    const Got got = run(frames, GetParam(), 128, false, wraps ? kRound_ns : 0);
    EXPECT_EQ(got.counts.missing, 29U);
    EXPECT_EQ(got.counts.repeated, 29U);
    EXPECT_EQ(got.counts.restarts, 0U);
    EXPECT_EQ(got.counts.samples + got.counts.repeated, 3000U);
    EXPECT_NEAR(got.dt_s, 3000 * kNominal_s, 1e-6);
  }
}

TEST_P(Counting, ABlockThatCameTwiceIsLeftOut) {
  std::vector<Sent> frames = on_time(2000, 65536);
  const std::vector<Sent> block(frames.begin() + 1000, frames.begin() + 1050);
  frames.insert(frames.begin() + 1050, block.begin(), block.end());
  const Got got = run(frames, GetParam(), 65536);
  EXPECT_EQ(got.counts.repeated, 50U);
  EXPECT_EQ(got.counts.restarts, 0U);
  EXPECT_EQ(got.counts.missing, 0U);
  EXPECT_NEAR(got.angle_rad, 2000 * kNominal_s * kTurning, 1e-9);
}

// The value tells each sample from the one before.
Reading counted(std::uint64_t number, std::uint32_t modulus, double arrives_s) {
  Reading reading;
  reading.arrival_ns = kStart_ns + std::llround(arrives_s * 1e9);
  reading.valid_axes = 1;
  reading.value[0] = static_cast<double>(number % 1000);
  reading.has_sequence = true;
  reading.sequence = static_cast<std::uint32_t>(number % modulus);
  return reading;
}
SensorFacts facts_of(double rate_hz, std::uint32_t modulus) {
  SensorFacts facts;
  facts.nominal_rate_hz = rate_hz;
  facts.sequence_modulus = modulus;
  return facts;
}

// What a host's read brings: so many frames at once, at the time of the last one.
struct Reads {
  std::uint32_t modulus;
  double rate_hz;
  std::uint64_t at_once;
};
class ShortRounds : public testing::TestWithParam<Reads> {};

IncrementerCounts read_all(const Reads& reads, std::uint64_t samples, std::uint64_t lost_every) {
  Incrementer incrementer(facts_of(reads.rate_hz, reads.modulus));
  Increment increment;
  for (std::uint64_t n = 0; n < samples; ++n) {
    if (lost_every != 0 && n % lost_every == lost_every / 2) continue;
    const std::uint64_t read = (n / reads.at_once + 1) * reads.at_once - 1;
    incrementer.next(counted(n, reads.modulus, static_cast<double>(read) / reads.rate_hz), increment);
  }
  return incrementer.counts();
}

TEST_P(ShortRounds, WhatIsReadSeveralAtOnceIsAllThere) {
  const IncrementerCounts counts = read_all(GetParam(), 5000, 0);
  EXPECT_EQ(counts.samples, 5000U);
  EXPECT_EQ(counts.missing, 0U);
  EXPECT_EQ(counts.repeated, 0U);
}

TEST_P(ShortRounds, SinglesThatAreLostAreCountedAsThat) {
  const IncrementerCounts counts = read_all(GetParam(), 5000, 501);
  EXPECT_EQ(counts.samples, 4990U);
  EXPECT_EQ(counts.missing, 10U);
  EXPECT_EQ(counts.repeated, 0U);
}

std::vector<Reads> short_rounds() {
  std::vector<Reads> out;
  for (const std::uint32_t modulus : {4U, 16U, 32U, 64U, 128U, 256U, 65536U})
    for (const double rate_hz : {125.0, 250.0, 500.0, 1000.0, 5000.0})
      for (const std::uint64_t at_once : {1U, 2U, 4U, 16U}) out.push_back({modulus, rate_hz, at_once});
  return out;
}
INSTANTIATE_TEST_SUITE_P(Devices, ShortRounds, testing::ValuesIn(short_rounds()),
                         [](const testing::TestParamInfo<Reads>& reads) {
                           return "modulus_" + std::to_string(reads.param.modulus) + "_at_" +
                                  std::to_string(static_cast<int>(reads.param.rate_hz)) + "_Hz_by_" +
                                  std::to_string(reads.param.at_once);
                         });

// One frame lost, and then a hold-up shorter than any that counts as a silence.
TEST(Rounds, AreNotMadeOfTimesThatFitAnyNumberOfThem) {
  for (const double held_s : {0.02, 0.04, 0.08, 0.19, 0.3}) {
    Incrementer incrementer(facts_of(1000.0, 128));
    Increment increment;
    for (std::uint64_t n = 0; n < 5000; ++n) {
      if (n == 3000) continue;
      const double taken_s = static_cast<double>(n) * 1e-3;
      incrementer.next(counted(n, 128, n > 3000 ? std::max(taken_s, 3.0 + held_s) : taken_s), increment);
    }
    EXPECT_EQ(incrementer.counts().missing, 1U) << held_s;
    EXPECT_EQ(incrementer.counts().samples, 4999U) << held_s;
  }
}

// Some of them of exactly a round or two, which nothing tells from a pause: those that follow are counted all
// the same, and the labels are right soon behind each.
TEST(Rounds, ThatNothingTellsFromAPauseSpoilNothingBehindThem) {
  struct Lost {
    double rate_hz;
    std::uint32_t modulus;
    std::vector<std::uint64_t> counts;
  };
  for (const Lost& lost :
       {Lost{1000.0, 128, {128, 135, 300, 256, 128, 130}}, Lost{125.0, 16, {16, 17, 300, 17, 16, 40}}}) {
    Incrementer incrementer(facts_of(lost.rate_hz, lost.modulus));
    Increment increment;
    std::uint64_t number = 0, told = 0, steps = 0;
    for (std::uint64_t n = 0; n < 8000 * (lost.counts.size() + 1); ++n, ++number) {
      if (n > 0 && n % 8000 == 0) {
        const std::uint64_t count = lost.counts[n / 8000 - 1];
        number += count;
        (count % lost.modulus == 0 ? steps : told) += count % lost.modulus == 0 ? 1 : count;
      }
      const Reading reading = counted(number, lost.modulus, static_cast<double>(number) / lost.rate_hz);
      ASSERT_TRUE(incrementer.next(reading, increment));
      if (n % 8000 != 7999) continue;
      EXPECT_EQ(incrementer.counts().missing, told) << lost.modulus << ", before sample " << n;
      EXPECT_EQ(incrementer.counts().pauses, steps) << lost.modulus << ", before sample " << n;
      EXPECT_EQ(incrementer.counts().clock_steps, 0U);  // nobody has set any
      EXPECT_NEAR(static_cast<double>(increment.utime_ns - reading.arrival_ns) * 1e-9, 0.0, 1e-3);
    }
  }
}

// A daemon that begins while much waits for it, as on a FIFO, and a line that goes to and fro with its first
// arrivals.
TEST(Labels, AreEachLaterThanTheOneBefore) {
  for (const std::uint64_t at_once : {1U, 2U, 3U, 8U, 16U, 500U}) {
    Incrementer incrementer(facts_of(1000.0, 128));
    Increment increment;
    std::int64_t before_us = 0;
    for (std::uint64_t n = 0; n < 5000; ++n) {
      const std::uint64_t read = std::max<std::uint64_t>((n / at_once + 1) * at_once - 1, 2000);
      const double arrives_s =
          1e-3 * static_cast<double>(read) + 1e-9 * static_cast<double>(n * 7919 % 20'000);
      ASSERT_TRUE(incrementer.next(counted(n, 128, arrives_s), increment));
      ASSERT_GT(increment.utime_ns / 1000, before_us) << at_once << ", sample " << n;
      before_us = increment.utime_ns / 1000;
    }
  }
}

// A cable that is out for a while: the counter alone would tell of less than a round.
TEST(Rounds, OfASilenceAreCountedHoweverShortTheyAre) {
  for (const double rate_hz : {1000.0, 5000.0}) {
    for (const double out_s : {1.5, 4.0}) {
      Incrementer incrementer(facts_of(rate_hz, 128));
      Increment increment;
      const auto lost = static_cast<std::uint64_t>(out_s * rate_hz);
      for (std::uint64_t n = 0; n < 20'000; ++n) {
        const std::uint64_t number = n < 10'000 ? n : n + lost;
        incrementer.next(counted(number, 128, static_cast<double>(number) / rate_hz), increment);
      }
      EXPECT_EQ(incrementer.counts().missing, lost) << rate_hz << ' ' << out_s;
    }
  }
}

TEST(Recorded, AClockThatWasSetWhileItWasRecordedLosesNothing) {
  for (const double set_s : {3600.0, -3600.0, 10.0, -10.0}) {
    std::vector<Sent> frames = on_time(2000, 65536);
    for (std::size_t i = 1000; i < frames.size(); ++i) frames[i].arrives_s += set_s;
    const Got got = run(frames, Tells::counter, 65536, true);
    EXPECT_EQ(got.counts.missing, 0U) << set_s;
    EXPECT_NEAR(got.dt_s, 2000 * kNominal_s, 1e-9) << set_s;
    EXPECT_EQ(got.clock_steps, 1U) << set_s;
    EXPECT_LT(got.worst_label_s, 2e-3) << set_s;
  }
}

TEST(Recorded, AClockThatWasSetBackWhileSamplesWereHeldUpLabelsThemAllTheSame) {
  std::vector<Sent> frames = on_time(2000, 65536);
  hold(frames, frames[1000].arrives_s, frames[1000].arrives_s + 0.5);
  for (std::size_t i = 1000; i < frames.size(); ++i) frames[i].arrives_s -= 40.0;
  const Got got = run(frames, Tells::counter, 65536, true);
  EXPECT_EQ(got.counts.missing, 0U);
  EXPECT_NEAR(got.dt_s, 2000 * kNominal_s, 1e-9);
  EXPECT_LT(got.worst_label_s, 2e-3);
}

TEST(DevicesClock, AJumpOfItAloneLosesNothing) {
  std::vector<Sent> frames = on_time(2000);
  for (std::size_t i = 1000; i < frames.size(); ++i) frames[i].device_s += 10.0;
  const Got got = run(frames, Tells::counter_and_clock);
  EXPECT_EQ(got.counts.missing, 0U);
  EXPECT_NEAR(got.covered_s, 2000 * kNominal_s, 1e-9);
  EXPECT_NEAR(got.dt_s, 2000 * kNominal_s, 1e-9);
}

TEST(DevicesClock, ARestartIsAsLongAsTheSilence) {
  std::vector<Sent> frames = on_time(600);
  for (Sent frame : on_time(600)) {
    frame.arrives_s += 7.0;  // a second of silence, and it counts from 0
    frames.push_back(frame);
  }
  const Got got = run(frames, Tells::counter_and_clock);
  EXPECT_EQ(got.counts.restarts, 1U);
  EXPECT_NEAR(got.dt_s, 13.0, 0.02);
  EXPECT_NEAR(static_cast<double>(got.counts.missing), 100.0, 1.0);
  EXPECT_NEAR(got.covered_s, 12.0, 1e-9);
}

}  // namespace
}  // namespace ifog
