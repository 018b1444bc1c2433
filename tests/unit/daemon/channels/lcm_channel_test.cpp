// SPDX-License-Identifier: Apache-2.0
// Environment channels from LCM messages.
#include <ifog/decode.h>
#include <lcm/lcm.h>

#include "daemon/channels/channel_sources.h"
#include "daemon/channels/channel_watch.h"
#include "daemon/channels/lcm_field.h"
#include "drivers/transport/clock.h"
#include "tests/unit/daemon/channels/awaited.h"
#include "tests/unit/daemon/private_network.h"
#include "tests/unit/messages.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

class LcmChannel : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = enter_private_network(); !why.empty())
      GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
    lcm_ = lcm_create(kUrl);
    ASSERT_NE(lcm_, nullptr);
  }
  void TearDown() override {
    if (lcm_ != nullptr) lcm_destroy(lcm_);
  }
  static ChannelConfig config(const std::string& lcm_channel) {
    ChannelConfig out;
    out.name = "coil_degC";
    out.source = ChannelConfig::Source::lcm;
    out.lcm_channel = lcm_channel;
    return out;
  }
  void send(const std::string& name, const std::vector<std::uint8_t>& message) {
    lcm_publish(lcm_, name.c_str(), message.data(), static_cast<unsigned>(message.size()));
  }

 private:
  lcm_t* lcm_ = nullptr;
};

TEST_F(LcmChannel, AnLcmMessageOfEitherType) {
  ChannelConfig one = config("HULL");
  one.scale = 2.0;
  ChannelConfig other = config("IFOG_TAIL_STATUS");
  other.field = "channel_value[temperature_degC]";
  const auto hull = std::make_shared<ChannelTable>(1), tail = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, hull, 0}, {other, tail, 0}}, kUrl);
  sources.start();
  status_t now = status();
  now.utime = realtime_ns() / 1000;
  send("HULL", encoded(channel("other_degC", 5.0)));
  send("HULL", encoded(channel("coil_degC", 10.0)));
  send("IFOG_TAIL_STATUS", encoded(now));
  EXPECT_EQ(await(*hull, 20.0).value, 20.0);
  const Value seen = await(*tail, 41.5);
  EXPECT_EQ(seen.value, 41.5);
  EXPECT_GE(seen.age_s, 2.0F);
  EXPECT_LT(seen.age_s, 60.0F);
}

// A name is a name: LCM would take it for a regular expression.
TEST_F(LcmChannel, AnLcmChannelIsTheOneOfThatName) {
  const std::vector<std::pair<std::string, std::string>> names = {{"HULL+1", "HULLL1"},
                                                                  {"HULL.2", "HULLx2"},
                                                                  {"(HULL)3", "HULL3"},
                                                                  {"HULL[4]", "HULL4"},
                                                                  {"HULL5$", "HULL5"}};
  for (const auto& [name, other] : names) {
    const auto hull = std::make_shared<ChannelTable>(1);
    ChannelSources sources({{config(name), hull, 0}}, kUrl);
    sources.start();
    send(name, encoded(channel("coil_degC", 21.0)));
    EXPECT_EQ(await(*hull, 21.0).value, 21.0) << name;
    send(other, encoded(channel("coil_degC", 99.0)));
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(look(*hull).value, 21.0) << other << " is heard as " << name;
  }
}

// By the sender's own dates, unless its clock was set back from a time that is still to come.
TEST_F(LcmChannel, ALateMessageNeverReplacesANewerOne) {
  ChannelConfig one = config("HULL");
  one.limits.maximum = 100.0;
  const auto hull = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, hull, 0}}, kUrl);
  sources.start();
  const std::int64_t now_us = realtime_ns() / 1000, hour_us = 3'600'000'000;
  const auto send = [&](double value, std::int64_t utime) {
    LcmChannel::send("HULL", encoded(channel("coil_degC", value, utime)));
  };
  send(22.0, now_us - 100'000);
  EXPECT_EQ(await(*hull, 22.0).value, 22.0);
  send(30.0, now_us - hour_us);
  for (int n = 0; n < 500 && hull->refused() == 0; ++n) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(hull->refused(), 1U);
  EXPECT_EQ(look(*hull).value, 22.0);
  EXPECT_LT(look(*hull).age_s, 60.0F);
  EXPECT_EQ(
      describe(one, hull->fault(0)),
      "channel 'coil_degC': LCM channel 'HULL': what comes was measured before what is held, by its utime");
  send(23.0, now_us - 50'000);
  EXPECT_EQ(await(*hull, 23.0).value, 23.0);
  // What is refused is not held: nothing is late for it. Sent twice it is counted once.
  for (int times = 0; times < 2; ++times) send(500.0, now_us - 20'000);
  send(23.5, now_us - 30'000);
  EXPECT_EQ(await(*hull, 23.5).value, 23.5);
  EXPECT_EQ(hull->refused(), 2U);
  // A sender from next year, which is then set right.
  send(24.0, now_us + 8760 * hour_us);
  EXPECT_EQ(await(*hull, 24.0).value, 24.0);
  // It grows old from when it came, also where it is sent again and again.
  for (int times = 1; times <= 3; ++times) {
    std::this_thread::sleep_for(200ms);
    EXPECT_GE(look(*hull).age_s, 0.19F * static_cast<float>(times));
    send(24.0, now_us + 8760 * hour_us);
  }
  send(25.0, now_us);
  EXPECT_EQ(await(*hull, 25.0).value, 25.0);
  // Without a date it is from now.
  send(26.0, 0);
  EXPECT_EQ(await(*hull, 26.0).value, 26.0);
  EXPECT_EQ(hull->refused(), 2U);
}

// Each value is new and all seem to be an hour old: that is the clock's, and they are fresh.
TEST_F(LcmChannel, AValueFromAComputerWhoseClockIsBehindIsFresh) {
  const ChannelConfig one = config("HULL");
  const auto hull = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, hull, 0}}, kUrl);
  sources.start();
  for (int n = 0; n < 5; ++n) {
    send("HULL", encoded(channel("coil_degC", 20.0 + n, realtime_ns() / 1000 - 3'600'000'000)));
    EXPECT_EQ(await(*hull, 20.0 + n).value, 20.0 + n);
  }
  EXPECT_LT(hull->latest(0).age_s(arrival_clock_ns()), 10.0F);
  EXPECT_EQ(
      describe(one, hull->fault(0)),
      "channel 'coil_degC': LCM channel 'HULL': the clock that dates it is 3600 s behind this computer's: "
      "ages are counted from the newest that has come");
}

// Values out of LCM messages, and messages that lie.

// Value and time in µs, or NaN where the field does not read the message.
std::pair<double, std::int64_t> read(const std::string& field, const std::vector<std::uint8_t>& message) {
  double value = NAN;
  std::int64_t utime = -1;
  if (!LcmField(field).read(message, value, utime)) return {NAN, -1};
  return {value, utime};
}

TEST(LcmField, ReadsTheThreeTypesByWhatTheyAre) {
  const auto c = encoded(channel("hull_degC", 21.5, 99)), r = encoded(rate()), s = encoded(status());
  using Pair = std::pair<double, std::int64_t>;
  EXPECT_EQ(read("hull_degC", c), Pair(21.5, 99));
  EXPECT_EQ(read("raw[1]", r), Pair(2.0, 7));
  EXPECT_EQ(read("compensated[0]", r), Pair(3.0, 7));
  EXPECT_EQ(read("denoised[1]", r), Pair(6.0, 7));
  EXPECT_EQ(read("clock_offset_ppm", s), Pair(-12.5, 5'000'000));
  EXPECT_EQ(read("latency_p99_us", s), Pair(88.0, 5'000'000));
  EXPECT_EQ(read("measurement_noise[0]", s), Pair(3e-9, 5'000'000));
  // Two seconds old where it was published: as old here.
  EXPECT_EQ(read("channel_value[temperature_degC]", s), Pair(41.5, 3'000'000));
}

// Counts and lengths of a message, each set to what ends a decoder that believes it: 32 bits everywhere, so
// that every count and every length is hit. Each attack ended the daemon, and with it every sensor.
template <typename Message>
void attack(const Message& message, const std::vector<std::string>& fields) {
  const std::vector<std::uint8_t> good = encoded(message);
  for (const std::uint32_t lie : {0xFFFFFFFFU, 0x7FFFFFFFU, 0x80000000U, 0U, 0x00FFFFFFU, 0x02000000U}) {
    for (std::size_t at = 8; at + 4 <= good.size(); ++at) {
      std::vector<std::uint8_t> bad = good;
      for (std::size_t i = 0; i < 4; ++i) bad[at + i] = static_cast<std::uint8_t>(lie >> (24 - 8 * i));
      Message out{};
      if (decode_message(bad, out)) {
        // Only numbers were hit, never a count.
        EXPECT_EQ(static_cast<std::size_t>(out.getEncodedSize()), bad.size()) << at << " " << lie;
      }
      for (const std::string& field : fields) (void)read(field, bad);
    }
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    Message out{};
    EXPECT_FALSE(decode_message(good.data(), size, out)) << size;
  }
  std::vector<std::uint8_t> longer = good;
  longer.push_back(0);
  Message out{};
  EXPECT_FALSE(decode_message(longer, out));
  EXPECT_TRUE(decode_message(good, out));
}

TEST(DecodeMessage, NoLieInAMessageEndsTheProgram) {
  attack(channel("hull_degC", 21.5), {"hull_degC"});
  attack(rate(), {"raw[0]", "denoised[1]"});
  attack(imu_t{}, {"raw[0]"});
  attack(status(), {"channel_value[supply_V]", "nis_mean[0]", "latency_p99_us", "hull_degC"});
  status_t with_allan = status();
  with_allan.octaves = 3;
  with_allan.allan_rate_radps = {{1.0, 2.0, 3.0}};
  with_allan.fault = "x";
  attack(with_allan, {"channel_value[supply_V]", "nis_mean[0]", "latency_p99_us", "hull_degC"});
}

TEST(DecodeMessage, AnUnknownDefinitionIsNoLayout) {
  EXPECT_THROW(MessageLayout("struct a {\n  other_t x;\n}"), std::invalid_argument);
  EXPECT_THROW(MessageLayout("struct a {\n  double x[n];\n}"), std::invalid_argument);
  EXPECT_NO_THROW(MessageLayout("struct a {\n  int8_t n; // count\n  double x[n];\n}"));
}

TEST(LcmField, WhatAMessageDoesNotHaveIsNotRead) {
  const auto c = encoded(channel("hull_degC", 21.5)), r = encoded(rate()), s = encoded(status());
  for (const auto& [field, message] : {std::pair{"other_degC", c},
                                       {"raw[0]", c},
                                       {"raw[2]", r},
                                       {"hull_degC", r},
                                       {"clock_offset_ppm", r},
                                       {"hull_degC", s},
                                       {"nis_mean[1]", s},
                                       {"channel_value[hull_degC]", s},
                                       // Never measured: an infinite age, not an old value.
                                       {"channel_value[supply_V]", s}})
    EXPECT_TRUE(std::isnan(read(field, message).first)) << field;
  std::vector<std::uint8_t> cut = s;
  cut.resize(cut.size() / 2);
  EXPECT_TRUE(std::isnan(read("clock_offset_ppm", cut).first));
}

}  // namespace
}  // namespace ifog
