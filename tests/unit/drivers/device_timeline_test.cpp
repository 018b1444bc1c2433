// SPDX-License-Identifier: Apache-2.0
// Every driver with a counter or a stamp, with frames that come twice, exchanged, late, not at all, or from a
// device that was switched off and on: what the daemon's chain and what a reader of raw bytes make of them.
#include "drivers/ifog/device_timeline.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <vector>

#include "daemon/sensor/facts.h"
#include "drivers/capture/capture_builder.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/drivers/disturbed_stream.h"
#include "tests/unit/drivers/start_time.h"

namespace ifog {
namespace {

constexpr std::int64_t kMicroseconds_ns = 4'294'967'296'000, kDay_ns = 86'400'000'000'000;

// A bus of one axis: with a counter of so many bits, with a stamp of 16 bits of 100 µs, or both.
std::string bus(const std::string& name, const std::string& more) {
  const std::string path = testing::TempDir() + "timeline_" + std::to_string(::getpid()) + name + ".dbc";
  std::ofstream(path) << "BO_ 256 Rate: 8 Gyro\n SG_ R : 0|32@1- (1,0) [-20|20] \"rad/s\" X\n"
                      << more << "SIG_VALTYPE_ 256 R : 1;\n";
  return path;
}

std::vector<Device> devices() {
  const std::string counter = " SG_ C : 32|16@1+ (1,0) [0|65535] \"\" X\n";
  const std::string four = " SG_ C : 32|6@1+ (1,0) [0|63] \"\" X\n";
  const std::string stamp = " SG_ T : 48|16@1+ (100,0) [0|0] \"us\" X\n";
  constexpr std::int64_t kShort_ns = 6'553'600'000;
  return {{"kvh1750", {{"format", "a"}}, 200.0, 0, false},
          {"kvh1750", {{"format", "b"}}, 200.0, kMicroseconds_ns, true},
          {"kvh1750", {{"format", "b"}, {"time_stamp", "pps"}}, 1000.0, 1'000'000'000, false},
          {"kvh1750", {{"format", "c"}}, 1000.0, 0, false},
          {"sbgecom", {}, 200.0, kMicroseconds_ns, true},
          {"sbgecom", {{"message", "imu_data"}}, 100.0, kMicroseconds_ns, true},
          {"stdbin", {{"version", "3"}}, 200.0, kDay_ns, true},
          {"stdbin", {{"version", "5"}}, 100.0, kDay_ns, true},
          {"stim300", {}, 250.0, 0, false},
          {"stim300", {}, 2000.0, 0, false},
          {"template", {}, 200.0, 0, false},
          {"dbc", {{"dbc", bus("c", counter)}, {"signal", "R"}, {"counter", "C"}}, 200.0, 0, true},
          {"dbc", {{"dbc", bus("f", four)}, {"signal", "R"}, {"counter", "C"}}, 200.0, 0, false},
          {"dbc", {{"dbc", bus("t", stamp)}, {"signal", "R"}, {"time", "T"}}, 200.0, kShort_ns, false},
          {"dbc",
           {{"dbc", bus("ct", counter + stamp)}, {"signal", "R"}, {"counter", "C"}, {"time", "T"}},
           200.0,
           kShort_ns,
           true}};
}

struct Case {
  std::size_t device;
  bool constant;  // a sensor that repeats one value: its frames are told apart by counter and stamp alone
};

class Disturbed : public testing::TestWithParam<Case> {
 protected:
  [[nodiscard]] Device device() const { return devices()[GetParam().device]; }
  [[nodiscard]] DriverInstance driver() const {
    DriverSettings settings = device().settings;
    settings.emplace("rate_hz", std::to_string(static_cast<int>(device().rate_hz)));
    return make_driver(device().name, settings);
  }
  // A second before the stamp goes round.
  [[nodiscard]] std::int64_t first_stamp_ns() const {
    return std::max<std::int64_t>(device().wrap_ns - 1'000'000'000, 0);
  }
};

template <typename Sink>
void decode(DriverInstance& driver, const Coming& one, std::int64_t arrival_ns, const Sink& sink) {
  if (!driver.takes_can()) return driver.decode_bytes(one.bytes, arrival_ns, sink);
  for (ifog_can_frame frame : one.frames) {
    frame.arrival_ns = arrival_ns;
    driver.decode_can(frame, sink);
  }
}

// What the chain finds of each frame that it takes, next to what is to be found.
struct Found {
  IncrementerCounts counts;
  double angle_rad = 0.0, dt_s = 0.0, covered_s = 0.0;
  std::size_t wrong_turn = 0, wrong_missing = 0, wrong_time = 0, clock_steps = 0;
};

Found through_the_chain(const std::vector<Coming>& coming, DriverInstance driver, const Device& device) {
  const SensorFacts facts = sensor_facts(driver.description(), 0.0, 0);
  Incrementer incrementer(facts);
  Found found;
  std::int64_t shift_ns = 0;
  std::size_t power_up = 0;
  for (const Coming& one : coming) {
    bool taken = false;
    Increment increment;
    const std::uint64_t missing = incrementer.counts().missing;
    decode(driver, one, kStart_ns + std::llround(one.arrives_s * 1e9), [&](const ifog_sample& sample) {
      Reading reading;
      read_sample(sample, facts.frame_channels, reading);
      taken = incrementer.next(reading, increment);
    });
    found.wrong_turn += taken != one.taken ? 1 : 0;
    if (!taken) continue;
    const bool anew = one.power_up != power_up;
    found.wrong_missing +=
        !anew && one.taken && incrementer.counts().missing - missing != one.missing ? 1 : 0;
    // From the first of a power-up on its time goes on as its clock does; that first is as it was sent.
    if (anew) shift_ns = increment.device_time_ns - one.stamp_ns;
    if (anew && device.wrap_ns > 0) found.wrong_time += increment.device_time_ns >= device.wrap_ns ? 1 : 0;
    if (device.wrap_ns > 0)
      found.wrong_time += std::abs(increment.device_time_ns - one.stamp_ns - shift_ns) > 200'000 ? 1 : 0;
    power_up = one.power_up;
    found.angle_rad += increment.delta_theta_rad[0];
    found.dt_s += increment.dt_s;
    found.covered_s += increment.covered_s[0];
    found.clock_steps += (increment.flags & kClockStep) != 0 ? 1 : 0;
  }
  found.counts = incrementer.counts();
  return found;
}

TEST_P(Disturbed, FramesAreTakenOnceInOrderAndNoTimeIsMade) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(device().name + ", seed " + std::to_string(seed));
    DisturbedStream stream(device(), seed, GetParam().constant);
    stream.power_up(10.0, first_stamp_ns(), 1200);
    stream.disturb(30, 9);
    const Found found = through_the_chain(stream.coming, driver(), device());
    const double period_s = 1.0 / device().rate_hz;
    double angle = 0.0;
    std::size_t taken = 0, missing = 0;
    for (const Coming& one : stream.coming) {
      angle += one.taken ? one.value * period_s : 0.0;
      taken += one.taken ? 1 : 0;
      missing += one.missing;
    }
    EXPECT_EQ(found.wrong_turn, 0U);
    EXPECT_EQ(found.wrong_missing, 0U);
    EXPECT_EQ(found.wrong_time, 0U);
    EXPECT_EQ(found.counts.restarts, 0U);
    EXPECT_EQ(found.counts.samples, taken);
    EXPECT_EQ(found.counts.repeated, stream.coming.size() - taken);
    EXPECT_EQ(found.counts.missing, missing);
    EXPECT_EQ(found.clock_steps, 0U);
    EXPECT_NEAR(found.dt_s, 1200 * period_s, 1e-6);
    EXPECT_NEAR(found.covered_s, static_cast<double>(taken) * period_s, 1e-6);
    EXPECT_NEAR(found.angle_rad, angle, 1e-6 * std::abs(angle));
  }
}

// Of raw bytes nothing is known but what is in them.
TEST_P(Disturbed, WhatIsReadWithoutAnyTimesOfArrivalIsTheSame) {
  if (GetParam().constant) return;  // of values alone a swap in a short counter cannot be told from a loss
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(device().name + ", seed " + std::to_string(seed));
    DisturbedStream stream(device(), seed, false);
    stream.power_up(10.0, first_stamp_ns(), 1200);
    stream.disturb(30, 5);
    DriverInstance reading = driver();
    CaptureBuilder builder(reading.description());
    std::vector<double> expected;
    std::size_t missing = 0;
    for (const Coming& one : stream.coming) {
      decode(reading, one, 0, [&](const ifog_sample& sample) { builder.add(sample); });
      if (one.taken) expected.push_back(one.value);
      missing += one.missing;
    }
    EXPECT_EQ(builder.missing(), missing);
    EXPECT_EQ(builder.repeated(), stream.coming.size() - expected.size());
    EXPECT_EQ(builder.restarts(), 0U);
    const Capture made = builder.finish();
    EXPECT_EQ(made.rate_radps[0], expected);
    EXPECT_NEAR(made.time_s.back() - made.time_s.front(), 1199 / device().rate_hz, 3e-4);
  }
}

// Off for 3.7 s, and the counter and the stamp begin again.
TEST_P(Disturbed, ADeviceThatWasSwitchedOffBeginsAnewAndMakesNoRound) {
  if (!device().restarts) return;
  DisturbedStream stream(device(), 7, GetParam().constant);
  const double period_s = 1.0 / device().rate_hz;
  double at_s = 10.0;
  for (const std::size_t samples : {1200U, 400U, 30U, 700U}) {
    const bool first = at_s == 10.0;
    stream.power_up(at_s, first ? first_stamp_ns() : 200'000'000, samples);
    at_s += static_cast<double>(samples) * period_s + 3.7;
  }
  stream.disturb(45, 9);
  const Found found = through_the_chain(stream.coming, driver(), device());
  EXPECT_EQ(found.wrong_turn, 0U);
  EXPECT_EQ(found.wrong_missing, 0U);
  EXPECT_EQ(found.wrong_time, 0U);
  EXPECT_EQ(found.counts.restarts, 3U);
  EXPECT_EQ(found.clock_steps, 0U);
  EXPECT_NEAR(found.dt_s, 2330 * period_s + 3 * 3.7, 0.05);
}

// The device stands still and goes on where it stopped, its counter and its clock as well.
TEST_P(Disturbed, APauseOfTheDeviceIsNoStepOfTheWallClock) {
  for (const double pause_s : {0.3, 0.6, 1.0, 1.28, 1.4, 1.7, 1.92}) {
    DisturbedStream stream(device(), 3, false);
    stream.power_up(10.0, 0, 2000);
    for (std::size_t i = 700; i < stream.coming.size(); ++i) stream.coming[i].arrives_s += pause_s;
    stream.judge();
    const Found found = through_the_chain(stream.coming, driver(), device());
    EXPECT_EQ(found.clock_steps, 0U) << device().name << ' ' << pause_s;
    EXPECT_EQ(found.counts.clock_steps, 0U);
    EXPECT_EQ(found.wrong_turn, 0U);
  }
}

// One frame again and again, and then the device goes on.
TEST_P(Disturbed, AFrozenDeviceMeasuresNothing) {
  DisturbedStream stream(device(), 5, GetParam().constant);
  stream.power_up(10.0, 0, 800);
  std::vector<Coming> frozen(stream.coming.begin(), stream.coming.begin() + 400);
  const double period_s = 1.0 / device().rate_hz;
  for (std::size_t i = 0; i < 3000; ++i) {
    frozen.push_back(stream.coming[399]);
    frozen.back().arrives_s += static_cast<double>(i + 1) * period_s;
  }
  for (std::size_t i = 400; i < 800; ++i) {
    frozen.push_back(stream.coming[i]);
    frozen.back().arrives_s += 3000 * period_s;
  }
  stream.coming = frozen;
  stream.judge();
  const Found found = through_the_chain(stream.coming, driver(), device());
  EXPECT_EQ(found.counts.samples, 800U);
  EXPECT_EQ(found.counts.repeated, 3000U);
  EXPECT_EQ(found.counts.missing, 0U);
  EXPECT_EQ(found.clock_steps, 0U);
}

std::vector<Case> cases() {
  std::vector<Case> out;
  for (std::size_t device = 0; device < devices().size(); ++device)
    for (const bool constant : {false, true}) out.push_back({device, constant});
  return out;
}
INSTANTIATE_TEST_SUITE_P(Drivers, Disturbed, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Case>& of) {
                           return devices()[of.param.device].name + "_" + std::to_string(of.param.device) +
                                  (of.param.constant ? "_constant" : "");
                         });

// An interface that went for some milliseconds: what was overtaken before it is late behind it, too, however
// often it comes. Behind a pause in which a device can begin anew it may be of one that has.
TEST(DeviceTimeline, AnInterruptionOfMillisecondsBeginsNoDeviceAnew) {
  for (const std::int64_t pause_ns : {1'000'000, 100'000'000, 600'000'000}) {
    DeviceTimeline timeline(1U << 16U, 1000.0, true);
    const auto frame = [](std::uint32_t number, std::int64_t arrival_ns, const double& value) {
      DeviceTimeline::Frame out;
      out.counts = true;
      out.sequence = number;
      out.arrival_ns = arrival_ns;
      out.values = {&value, 1};
      return out;
    };
    std::vector<double> values(400);
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = 1e-3 * static_cast<double>(n * 37 % 401);
    const std::int64_t begin_ns = 1'000'000'000'000;
    timeline.first(frame(0, begin_ns, values[0]));
    std::int64_t now_ns = begin_ns;
    for (std::uint32_t n = 1; n < 300; ++n) {
      now_ns += 1'000'000;
      if (n == 298) continue;  // it comes behind the next
      EXPECT_FALSE(timeline.next(frame(n, now_ns, values[n])).out_of_turn) << n;
    }
    EXPECT_TRUE(timeline.next(frame(298, now_ns, values[298])).out_of_turn);
    now_ns += pause_ns;
    DeviceTimeline::Frame again = frame(298, now_ns, values[298]);
    again.reopened = true;
    const DeviceTimeline::Step step = timeline.next(again);
    EXPECT_EQ(step.out_of_turn, pause_ns < 250'000'000) << pause_ns;
    if (!step.out_of_turn) continue;
    const DeviceTimeline::Step on = timeline.next(frame(300, now_ns + 1'000'000, values[300]));
    EXPECT_FALSE(on.out_of_turn || on.restarted);
  }
}

// Rounds of the stamp that nobody saw, by the times of arrival; and none for what is only late.
TEST(RollingStamp, ThreeHoursOfSilenceAreTwoRoundsOf71Minutes) {
  RollingStamp stamp;
  const auto at = [&](std::int64_t us, double elapsed_s) {
    const RollingStamp::Stamp sent{us * 1000, kMicroseconds_ns};
    stamp.take(sent, stamp.look(sent, {elapsed_s, 1e-3, elapsed_s}));
    return stamp.time_ns();
  };
  const std::int64_t start = at(0xFFFFFF00, -1.0);
  EXPECT_EQ(at(0xF4, 5e-4) - start, 500'000);
  EXPECT_EQ(at(0xF4, 2e-9 * static_cast<double>(kMicroseconds_ns) + 5e-3) - start,
            2 * kMicroseconds_ns + 500'000);
}

// 20 a second and 16 bits of microseconds: three quarters of a round from one sample to the next.
TEST(RollingStamp, AStepOfHardlyMoreThanASampleIsNeverBack) {
  constexpr std::int64_t kPeriod_ns = 50'000'000, kRound_ns = 65'536'000;
  for (const int at_once : {0, 1, 4}) {  // 0: untimed
    RollingStamp stamp;
    std::int64_t before_ns = 0;
    for (std::int64_t n = 0; n < 1000; ++n) {
      const RollingStamp::Stamp sent{n * kPeriod_ns % kRound_ns, kRound_ns};
      const double elapsed_s = at_once == 0 ? -1.0 : n % at_once == 0 ? 0.05 * at_once : 1e-4;
      stamp.take(sent, stamp.look(sent, {elapsed_s, 0.05, elapsed_s}));
      if (n > 0) {
        ASSERT_EQ(stamp.time_ns() - before_ns, kPeriod_ns) << n << ' ' << at_once;
      }
      before_ns = stamp.time_ns();
    }
  }
}

// Further apart than 64 bits hold: what has no room wraps, and overflows nothing.
TEST(RollingStamp, StampsMayBeAnyThatHasRoom) {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min(),
                         kMost = std::numeric_limits<std::int64_t>::max();
  RollingStamp stamp;
  stamp.take({kLeast + 5, 1000}, kLeast + 5);
  EXPECT_EQ(stamp.look({kMost - 5, 1000}, {1e-3, 1e-3, 1e-3}), kLeast + 5 + 989);
  for (const std::int64_t from_ns : {kLeast, std::int64_t{-1}, std::int64_t{0}, kMost})
    for (const double elapsed_s : {-1.0, 1e-3, 9e9}) {
      stamp.take({from_ns, kMost}, from_ns);
      EXPECT_EQ(stamp.look({from_ns, kMost}, {elapsed_s, 1e-3, elapsed_s, 1e-3}), from_ns);
    }
}

TEST(RollingStamp, AStampOfASecondHeldUpForMostOfOneMakesNoRound) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  RollingStamp stamp;
  std::int64_t before_ns = 0;
  for (std::int64_t n = 0; n < 5000; ++n) {
    const RollingStamp::Stamp sent{n * 1'000'000 % kSecond_ns, kSecond_ns};
    const bool held = n >= 2300 && n < 3100;  // all of these come with the last
    const double elapsed_s = n == 2300 ? 0.8 : held ? 0.0 : 1e-3;
    stamp.take(sent, stamp.look(sent, {elapsed_s, 1e-3, elapsed_s}));
    if (n > 0) {
      ASSERT_EQ(stamp.time_ns() - before_ns, 1'000'000) << n;
    }
    before_ns = stamp.time_ns();
  }
}

}  // namespace
}  // namespace ifog
