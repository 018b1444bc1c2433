// SPDX-License-Identifier: Apache-2.0
// Channels without a new value are reported by name, with the place they should come from and the reason.
#include "daemon/channels/channel_watch.h"
#include "daemon/sensor/facts.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Second {
  double frame_age_s, file_age_s, lcm_age_s;
};

class Watched {
 public:
  Watched() : table(2), watch_(sensor(), {"temperature_degC", "coil_degC", "hull_degC"}) {
    status_.state = status_t::STATE_RUNNING;
    status_.samples_in = 1;
  }
  // What is said in one second.
  std::string look(const Second& now) {
    status_.channel_age_s = {now.frame_age_s, now.file_age_s, now.lcm_age_s};
    std::string out;
    for (const ChannelWatch::News& news : watch_.look(status_, table))
      out += (news.good ? "good: " : "bad: ") + news.words + "\n";
    return out;
  }
  // A correction goes without a channel.
  void go_stale() { status_.channel_stale = 7; }
  void silence() { status_.state = status_t::STATE_NO_DATA; }

  ChannelTable table;

 private:
  static SensorConfig sensor() {
    SensorConfig out;
    ChannelConfig file, lcm;
    file.name = "coil_degC";
    file.source = ChannelConfig::Source::file;
    file.path = "/run/coil";
    lcm.name = "hull_degC";
    lcm.source = ChannelConfig::Source::lcm;
    lcm.lcm_channel = "HULL";
    lcm.max_age_s = 3.0;
    out.channels = {file, lcm};
    return out;
  }
  ChannelWatch watch_;
  status_t status_{};
};

TEST(ChannelWatch, AFileThatVanishesIsToldOnceWithItsPath) {
  Watched all;
  all.table.set(0, 20.0, 1);
  EXPECT_EQ(all.look({0.0, 0.5, 0.5}), "");
  all.table.miss(0, {.kind = ChannelFault::Kind::unreadable, .error = ENOENT});
  for (int second = 1; second <= 10; ++second) EXPECT_EQ(all.look({0.0, 1.0 * second, 0.5}), "") << second;
  EXPECT_EQ(
      all.look({0.0, 10.5, 0.5}),
      "bad: channel 'coil_degC': /run/coil: cannot read: No such file or directory, expected a file that "
      "holds one number; the last value is held\n");
  for (int second = 12; second <= 30; ++second) EXPECT_EQ(all.look({0.0, 1.0 * second, 0.5}), "") << second;
  all.table.set(0, 21.0, 2);
  EXPECT_EQ(all.look({0.0, 0.5, 0.5}), "good: channel 'coil_degC' has new values\n");
}

TEST(ChannelWatch, AChannelThatNeverComesIsToldOnce) {
  Watched all;
  all.table.miss(0, {.kind = ChannelFault::Kind::no_file});
  std::string told;
  for (int second = 1; second <= 30; ++second) told += all.look({0.0, kNever, kNever});
  EXPECT_EQ(
      told,
      "bad: channel 'coil_degC': /run/coil: is no regular file, expected a file that holds one number; the "
      "channel has no value yet\n"
      "bad: channel 'hull_degC': LCM channel 'HULL': nothing comes; the channel has no value yet\n");
}

// A driver's frames could bring more than those of this format do.
TEST(ChannelWatch, AFramesChannelThatNobodyMissesIsNotTold) {
  Watched all;
  all.table.set(0, 20.0, 1);
  for (int second = 0; second < 100; ++second) EXPECT_EQ(all.look({kNever, 0.5, 0.5}), "") << second;
  all.go_stale();
  EXPECT_EQ(
      all.look({kNever, 0.5, 0.5}),
      "bad: channel 'temperature_degC': the sensor's frames bring none; the channel has no value yet\n");
  EXPECT_EQ(all.look({kNever, 0.5, 0.5}), "");
  EXPECT_EQ(all.look({0.0, 0.5, 0.5}), "good: channel 'temperature_degC' has new values\n");
}

TEST(ChannelWatch, WhatComesAndIsNoValueIsSaid) {
  Watched all;
  all.table.refuse(1, {.kind = ChannelFault::Kind::no_message});
  EXPECT_EQ(all.table.refused(), 1U);
  EXPECT_EQ(all.look({0.0, 0.5, 4.0}),
            "bad: channel 'hull_degC': LCM channel 'HULL': what comes is no ifog.channel_t, ifog.rate_t or "
            "ifog.status_t; the last value is held\n");
  EXPECT_EQ(all.look({11.0, 0.5, 4.0}),
            "bad: channel 'temperature_degC': the sensor's frames bring none; the last value is held\n");
}

// Reported at the start, before anything is opened, it is not reported again.
TEST(ChannelWatch, WhatIsNotThereAtTheStartIsToldOnce) {
  SensorConfig sensor;
  ChannelConfig file, can;
  file.name = "coil_degC";
  file.source = ChannelConfig::Source::file;
  file.path = "/nonexistent";
  can.name = "hull_degC";
  can.source = ChannelConfig::Source::can;
  can.interface = "no-bus";
  sensor.channels = {file, can};
  ChannelWatch watch(sensor, {"coil_degC", "hull_degC"});
  EXPECT_EQ(
      watch.absent(),
      (std::vector<std::string>{
          "channel 'coil_degC': /nonexistent: cannot read: No such file or directory, expected a file that "
          "holds one number; the channel has no value until it comes",
          "channel 'hull_degC': CAN interface 'no-bus': is not there; the channel has no value until it "
          "comes"}));
  ChannelTable table(2);
  table.miss(0, {.kind = ChannelFault::Kind::unreadable, .error = ENOENT});
  status_t status{};
  status.state = status_t::STATE_RUNNING;
  status.samples_in = 1;
  status.channel_age_s = {kNever, kNever};
  for (int second = 0; second < 30; ++second) EXPECT_TRUE(watch.look(status, table).empty());
  table.set(0, 20.0, 1);
  status.channel_age_s[0] = 0.1;
  ASSERT_EQ(watch.look(status, table).size(), 1U);
}

// Other fields' messages on the same LCM channel are no fault of one whose values come.
TEST(ChannelWatch, MessagesOfOthersAreNoFault) {
  Watched all;
  for (int second = 0; second < 60; ++second) {
    all.table.miss(1, {.kind = ChannelFault::Kind::no_field});
    EXPECT_EQ(all.look({0.0, 0.5, 1.0}), "");
  }
}

TEST(ChannelWatch, OfASilentSensorNothingIsKnown) {
  Watched all;
  all.silence();
  for (int second = 0; second < 60; ++second) EXPECT_EQ(all.look({60.0, kNever, kNever}), "");
}

// No temperature is below absolute zero, whichever way it comes; oracle: -273.15 degC.
TEST(ChannelLimits, AValueIsWithinWhatItsUnitCanBe) {
  ifog_description description{};
  description.axes = 1;
  description.nominal_rate_hz = 100.0;
  description.environments = 1;
  std::string("temperature_degC").copy(description.environment[0], sizeof description.environment[0] - 1);
  Incrementer incrementer(sensor_facts(description, 0.0, 0));
  Reading reading;
  reading.valid_axes = 1;
  reading.fresh_channels = 1;
  Increment out;
  for (const double value : {25.0, -1000.0, -273.2, -273.1}) {
    reading.channel[0] = value;
    reading.value[0] += 1e-4;
    ASSERT_TRUE(incrementer.next(reading, out));
    EXPECT_EQ(out.channel[0], value < -273.15 ? 25.0 : value);
  }
  EXPECT_EQ(incrementer.counts().channel_implausible, 2U);
  const Limits said = channel_limits("coil_degC", {.minimum = -400.0, .maximum = 85.0});
  EXPECT_EQ(said.minimum, -273.15);
  EXPECT_EQ(said.maximum, 85.0);
}

}  // namespace
}  // namespace ifog
