// SPDX-License-Identifier: Apache-2.0
// A counter of one byte or less goes round many times in a silence. Whether frames were lost in it or held up
// on their way shows in how those behind it come; against what was sent and what was lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "filters/chain/incrementer.h"

namespace ifog {
namespace {

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

struct Device {
  double rate_hz;
  std::uint32_t modulus;
};
constexpr Device kDevices[] = {{500.0, 128}, {1000.0, 128}, {200.0, 128}, {250.0, 256}, {100.0, 16}};

struct Frame {
  std::uint64_t number;
  double arrives_s;
  double stood_s = 0.0;  // still, up to here, while its clock went on
  bool reopened = false;
  bool timed = true;  // its arrival is known
};

// What stands between the device and the reader: nothing passes in a silence, and what it held passes behind
// it, in so many frames at a time, so much faster than it was taken.
struct Link {
  std::vector<std::pair<double, double>> silences_s;  // begin, how long
  double faster = 1e6;
  std::uint64_t at_once = 1;
  double keeps_s = 1e9;  // what is older at the end of a silence is lost
};

std::vector<Frame> through(const Link& link, const Device& device, std::uint64_t samples) {
  std::vector<Frame> out;
  double free_s = 0.0;
  for (std::uint64_t n = 0; n < samples; ++n) {
    const double taken_s = static_cast<double>(n) / device.rate_hz;
    double from_s = taken_s + 2e-4 * static_cast<double>(n * 7919 % 101) / 101.0;
    bool lost = false;
    for (const auto& [begin_s, long_s] : link.silences_s) {
      const double end_s = begin_s + long_s;
      if (taken_s < begin_s || taken_s >= end_s) continue;
      from_s = end_s;
      lost = taken_s < end_s - link.keeps_s;
    }
    if (lost) continue;
    free_s = std::max(from_s, free_s + 1.0 / device.rate_hz / link.faster);
    out.push_back({n, free_s});
  }
  // What comes together comes with the last of it.
  for (std::size_t i = 0; i < out.size(); i += link.at_once) {
    const std::size_t end = std::min(i + static_cast<std::size_t>(link.at_once), out.size());
    for (std::size_t k = i; k < end; ++k) out[k].arrives_s = out[end - 1].arrives_s;
  }
  return out;
}

struct Got {
  IncrementerCounts counts;
  double dt_s = 0.0, covered_s = 0.0, worst_label_s = 0.0, interval_error = 0.0;
  std::uint64_t most_missing = 0;  // before any one sample
};

// wrap_ns: in which the device's stamp goes round; 0: it has none.
Got run(const std::vector<Frame>& frames, const Device& device, std::int64_t wrap_ns = 0) {
  SensorFacts facts;
  facts.nominal_rate_hz = device.rate_hz;
  facts.sequence_modulus = device.modulus;
  Incrementer incrementer(facts);
  Increment increment;
  Got got;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Reading reading;
    reading.arrival_ns = frames[i].timed ? kStart_ns + std::llround(frames[i].arrives_s * 1e9) : 0;
    if (frames[i].reopened) incrementer.discontinuity();
    reading.valid_axes = 1;
    reading.value[0] = static_cast<double>(frames[i].number % 1009);
    reading.has_sequence = true;
    reading.sequence = static_cast<std::uint32_t>(frames[i].number % device.modulus);
    if (wrap_ns > 0)
      reading.device_time_ns =
          std::llround((static_cast<double>(frames[i].number) / device.rate_hz + frames[i].stood_s) * 1e6) *
          1000 % wrap_ns;
    reading.device_wrap_ns = wrap_ns;
    const std::uint64_t before = incrementer.counts().missing;
    EXPECT_TRUE(incrementer.next(reading, increment)) << i;
    got.most_missing = std::max(got.most_missing, incrementer.counts().missing - before);
    got.dt_s += increment.dt_s;
    got.covered_s += increment.covered_s[0];
    if (i + 50 < frames.size()) continue;
    const double taken_s = static_cast<double>(frames[i].number) / device.rate_hz;
    got.worst_label_s = std::max(
        got.worst_label_s, std::abs(static_cast<double>(increment.utime_ns - kStart_ns) * 1e-9 - taken_s));
  }
  got.counts = incrementer.counts();
  got.interval_error = incrementer.interval_error();
  return got;
}

void expect_truth(const Link& link, const Device& device) {
  const auto samples = static_cast<std::uint64_t>(60.0 * device.rate_hz);
  const std::vector<Frame> frames = through(link, device, samples);
  const Got got = run(frames, device);
  EXPECT_EQ(got.counts.samples, frames.size());
  EXPECT_EQ(got.counts.missing, samples - frames.size());
  EXPECT_EQ(got.counts.restarts, 0U);
  EXPECT_EQ(got.counts.pauses, 0U);
  EXPECT_NEAR(got.dt_s, 60.0, 1e-9);
  EXPECT_NEAR(got.interval_error, 0.0, 2e-3);
  EXPECT_LT(got.worst_label_s, 0.01 + static_cast<double>(link.at_once) / device.rate_hz);
}

// To the sample whole rounds, nearly, and anything else; once, and a second time before the first is
// forgotten.
TEST(LostRounds, WhatWasHeldUpForSecondsIsAllThere) {
  for (const Device& device : kDevices)
    for (const double rounds : {8.0, 9.0, 9.02, 9.1, 9.5, 12.0, 13.0, 20.0})
      for (const double faster : {1.3, 3.3, 1e6})
        for (const std::uint64_t at_once : {1U, 3U})
          for (const double again_s : {0.0, 8.13}) {
            const double held_s =
                std::max(rounds, std::ceil(2.02 * device.rate_hz / device.modulus) + rounds - 8.0) *
                device.modulus / device.rate_hz;
            Link link{{{6.0, held_s}}, faster, at_once};
            if (again_s > 0.0 && 6.0 + held_s * (1.0 + 1.0 / (faster - 1.0)) + again_s < 50.0)
              link.silences_s.emplace_back(6.0 + held_s + again_s, 2.43);
            if (6.0 + held_s * (1.0 + 1.0 / (faster - 1.0)) > 35.0) continue;  // not drained at the end
            SCOPED_TRACE(testing::Message()
                         << device.rate_hz << " Hz, " << device.modulus << ", held " << held_s
                         << " s, drains at " << faster << ", by " << at_once << ", again after " << again_s);
            expect_truth(link, device);
          }
}

TEST(LostRounds, WhatASilenceSwallowedIsCountedToTheSample) {
  for (const Device& device : kDevices)
    for (const double silent_s : {2.304, 2.56, 3.0, 5.12, 10.0})
      for (const std::uint64_t at_once : {1U, 3U}) {
        SCOPED_TRACE(testing::Message() << device.rate_hz << " Hz, " << device.modulus << ", silent "
                                        << silent_s << " s, by " << at_once);
        expect_truth({{{6.0, silent_s}, {25.0, silent_s}}, 1e6, at_once, 0.0}, device);
      }
}

// A serial server that keeps what comes while nobody is connected; a reader that was stopped itself, and has
// no times of arrival until all that had piled up is through. What of it was lost is lost, and no more.
TEST(LostRounds, WhatWasKeptBehindAReconnectionOrAStopIsAllThere) {
  for (const Device& device : kDevices)
    for (const double silent_s : {2.5, 3.1, 6.0})
      for (const double keeps_s : {0.4, 1e9})
        for (const double faster : {3.5, 1e6})
          for (const bool stopped : {false, true}) {
            if (device.modulus == 16 && keeps_s < 1.0) continue;  // two rounds of it are a fifth of a second
            SCOPED_TRACE(testing::Message()
                         << device.rate_hz << " Hz, " << device.modulus << ", silent " << silent_s
                         << " s, kept " << keeps_s << " s, drains at " << faster << ", stopped " << stopped);
            const auto samples = static_cast<std::uint64_t>(30.0 * device.rate_hz);
            std::vector<Frame> frames = through({{{6.0, silent_s}}, faster, 1, keeps_s}, device, samples);
            bool first = true;
            for (Frame& frame : frames) {
              const double taken_s = static_cast<double>(frame.number) / device.rate_hz;
              if (taken_s < 6.0) continue;
              if (stopped)
                frame.timed = taken_s >= 6.0 + silent_s;
              else
                frame.reopened = std::exchange(first, false);
            }
            const Got got = run(frames, device);
            EXPECT_EQ(got.counts.missing, samples - frames.size());
            EXPECT_NEAR(got.dt_s, 30.0, 1e-9);
          }
}

// A sender that stands still and goes on with its count, as a programme that sends a file does between two of
// them: so one in a round's number of losses would look, every pause does.
TEST(LostRounds, AreNotMadeOfADevicesPause) {
  for (const Device& device : kDevices)
    for (const std::uint64_t before : {20U, 3000U})
      for (const double pause_s : {2.2, 3.37, 9.7, 30.51, 611.07}) {
        std::vector<Frame> frames = through({{}}, device, before + 4000);
        for (std::size_t i = before; i < frames.size(); ++i) frames[i].arrives_s += pause_s;
        const double off = std::remainder(pause_s * device.rate_hz, static_cast<double>(device.modulus));
        if (std::abs(off) < 6.0) continue;  // which nothing tells from rounds
        SCOPED_TRACE(testing::Message() << device.rate_hz << " Hz, " << device.modulus << ", " << pause_s
                                        << " s behind " << before);
        const Got got = run(frames, device);
        EXPECT_EQ(got.counts.missing, 0U);
        EXPECT_EQ(got.counts.pauses, 1U);
        EXPECT_NEAR(got.dt_s, static_cast<double>(before + 4000) / device.rate_hz, 1e-9);
      }
}

// Of one whose clock goes on while it measures nothing: no sample takes seconds.
TEST(LostRounds, WhileADeviceStoodStillNothingWasMeasured) {
  for (const Device& device : {Device{100.0, 65536}, Device{500.0, 1U << 31U}, Device{1000.0, 128}})
    for (const double stood_s : {0.3, 1.0, 5.0, 60.0}) {
      SCOPED_TRACE(testing::Message()
                   << device.rate_hz << " Hz, " << device.modulus << ", " << stood_s << " s");
      std::vector<Frame> frames = through({{}}, device, 6000);
      for (std::size_t i = 3000; i < frames.size(); ++i) {
        frames[i].arrives_s += stood_s;
        frames[i].stood_s = stood_s;
      }
      const Got got = run(frames, device, std::int64_t{1} << 50U);
      EXPECT_NEAR(got.covered_s, 6000.0 / device.rate_hz, 1e-3);
      EXPECT_NEAR(got.dt_s, 6000.0 / device.rate_hz + stood_s, 2e-3);
      EXPECT_EQ(got.counts.gaps, 1U);
    }
}

// One that is told to measure at a tenth of its rate does not stand still between any two.
TEST(LostRounds, AreNotMadeOfALowerRate) {
  const Device device{1000.0, 65536};
  std::vector<Frame> frames = through({{}}, device, 6000);
  for (std::size_t i = 3000; i < frames.size(); ++i) {
    frames[i].stood_s = 9e-3 * static_cast<double>(i - 2999);
    frames[i].arrives_s += frames[i].stood_s;
  }
  const Got got = run(frames, device, std::int64_t{1} << 50U);
  EXPECT_LE(got.counts.missing, 10U);
  EXPECT_NEAR(got.covered_s, 33.0, 0.01);
}

// A serial server whose buffer was too small for the silence: its oldest are lost, and the others come at
// once.
TEST(LostRounds, WhatIsLostOfWhatWasHeldUpIsCountedToTheSample) {
  for (const Device& device : kDevices)
    for (const double silent_s : {1.6, 2.56, 3.0, 4.1})
      for (const double keeps_s : {0.2, 0.5, 1.1})
        for (const double faster : {2.0, 1e6}) {
          SCOPED_TRACE(testing::Message() << device.rate_hz << " Hz, " << device.modulus << ", silent "
                                          << silent_s << " s, kept " << keeps_s << " s");
          expect_truth({{{6.0, silent_s}}, faster, 1, keeps_s}, device);
        }
}

// A stamp that begins anew each second goes round in a silence, too: only what is whole rounds of both is
// not told.
TEST(LostRounds, AStampThatGoesRoundAsWellMakesNone) {
  for (const Device& device : {Device{200.0, 128}, Device{500.0, 128}, Device{1000.0, 128}})
    for (const double silent_s : {1.5, 2.2, 2.56, 3.0, 3.2, 5.0})
      for (const double keeps_s : {0.0, 1e9}) {
        SCOPED_TRACE(testing::Message()
                     << device.rate_hz << " Hz, silent " << silent_s << " s, keeps " << keeps_s);
        const auto samples = static_cast<std::uint64_t>(30.0 * device.rate_hz);
        const std::vector<Frame> frames = through({{{7.0, silent_s}}, 1e6, 1, keeps_s}, device, samples);
        const Got got = run(frames, device, 1'000'000'000);
        EXPECT_EQ(got.counts.missing, samples - frames.size());
        EXPECT_EQ(got.counts.sensor_clock_sets, 0U);
        EXPECT_NEAR(got.dt_s, 30.0, 1e-3);
      }
}

// A short hold-up with a gap at its beginning, behind which the line of the times of arrival begins.
TEST(LostRounds, OfAShortHoldUpNoOtherRateIsMade) {
  for (const Device& device : kDevices)
    for (const double silent_s : {0.3, 0.6, 0.9}) {
      SCOPED_TRACE(testing::Message()
                   << device.rate_hz << " Hz, " << device.modulus << ", silent " << silent_s);
      const auto samples = static_cast<std::uint64_t>(60.0 * device.rate_hz);
      const double lost_s = 5.0 / device.rate_hz;
      const Got got = run(through({{{30.0, silent_s}}, 1e6, 1, silent_s - lost_s}, device, samples), device);
      EXPECT_NEAR(got.interval_error, 0.0, 1e-3);
    }
}

// What nothing tells is no more than the silence has room for, and stays so however many there are.
TEST(LostRounds, NoSilenceHoldsMoreThanItsTime) {
  const Device device{500.0, 128};
  for (const double held_s : {2.3, 2.43, 3.05}) {
    Link link{{}, 1.02, 1};
    for (double at_s = 6.0; at_s < 40.0; at_s += held_s + 3.7) link.silences_s.emplace_back(at_s, held_s);
    const Got got = run(through(link, device, 30'000), device);
    EXPECT_LE(static_cast<double>(got.most_missing), (held_s + 3.0) * device.rate_hz * 1.01);
  }
}

}  // namespace
}  // namespace ifog
