// SPDX-License-Identifier: Apache-2.0
// Environment channels from outside a sensor's own frames: a file, an LCM message, another CAN frame.
#include "daemon/channels/channel_sources.h"

#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "drivers/transport/clock.h"
#include "tests/unit/daemon/messages.h"
#include "tests/unit/daemon/private_network.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;
constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

struct Value {
  double value;
  float age_s;
};

Value look(const ChannelTable& table) {
  Value out{};
  const ChannelValue latest = table.latest(0);
  out.value = latest.value;
  out.age_s = latest.age_s(realtime_ns());
  return out;
}

// Waits for a value; the test's own time limit ends a wait that would never.
Value await(const ChannelTable& table, double value) {
  Value seen = look(table);
  for (int i = 0; i < 2000 && seen.value != value; ++i, seen = look(table)) std::this_thread::sleep_for(5ms);
  return seen;
}

ChannelConfig config(ChannelConfig::Source source) {
  ChannelConfig out;
  out.name = "coil_degC";
  out.source = source;
  return out;
}

TEST(ChannelSources, AFileIsReadAgainAndAgain) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("ifog-channel-" + std::to_string(getpid()));
  std::ofstream(path) << "41250\n";
  ChannelConfig one = config(ChannelConfig::Source::file);
  one.path = path;
  one.scale = 1e-3;
  one.offset = 0.5;
  one.period_s = 0.01;
  const auto table = std::make_shared<ChannelTable>(1);
  EXPECT_TRUE(std::isnan(look(*table).value));
  EXPECT_TRUE(std::isinf(look(*table).age_s));
  ChannelSources sources({{one, table, 0}}, kUrl);
  sources.start();
  EXPECT_EQ(await(*table, 41.75).value, 41.75);
  EXPECT_LT(look(*table).age_s, 60.0F);
  std::ofstream(path) << "-2000\n";
  EXPECT_EQ(await(*table, -1.5).value, -1.5);
  // No number any more: the last value stays, and grows old.
  std::ofstream(path) << "no number\n";
  std::this_thread::sleep_for(50ms);
  const Value first = look(*table);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(look(*table).value, -1.5);
  EXPECT_GT(look(*table).age_s, first.age_s);
  sources.stop();
  std::filesystem::remove(path);
}

// Gives its frames once and then waits, as a bus does.
class FakeBus final : public Transport {
 public:
  explicit FakeBus(std::vector<ifog_can_frame> frames, std::uint64_t drops = 0, std::uint64_t last = 0)
      : Transport("fake0"), frames_(std::move(frames)), drops_(drops), last_(last) {}
  bool connect(std::string&, std::int64_t) override { return true; }
  // Of these the kernel tells only when it is asked at the end.
  void count_losses() noexcept override { counters_.kernel_drops.add(std::exchange(last_, 0)); }
  Delivery receive(std::int64_t until_ns) noexcept override {
    Delivery out;
    counters_.kernel_drops.add(std::exchange(drops_, 0));
    out.frames = std::exchange(given_, true) ? std::span<const ifog_can_frame>() : frames_;
    short happened = 0;
    if (out.empty()) waiting_.wait(-1, 0, until_ns, happened);
    return out;
  }

 private:
  std::vector<ifog_can_frame> frames_;
  std::uint64_t drops_, last_;
  bool given_ = false;
};

ifog_can_frame environment(std::uint32_t id, float temperature_degC, float supply_V) {
  ifog_can_frame out{};
  out.id = id;
  out.length = 8;
  out.arrival_ns = realtime_ns();
  std::memcpy(out.data, &temperature_degC, 4);
  std::memcpy(out.data + 4, &supply_V, 4);
  return out;
}

TEST(ChannelSources, AFifoInTheFilesPlaceHoldsNothingUp) {
  const std::string folder = std::filesystem::temp_directory_path().string();
  const std::string fifo = folder + "/ifog-fifo-" + std::to_string(getpid()), file = fifo + "-file";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::ofstream(file) << "7\n";
  ChannelConfig waits = config(ChannelConfig::Source::file), works = waits;
  waits.path = fifo;
  works.path = file;
  waits.period_s = works.period_s = 0.01;
  const auto table = std::make_shared<ChannelTable>(2);
  ChannelSources sources({{waits, table, 0}, {works, table, 1}}, kUrl);
  sources.start();
  double value = NAN;
  for (int n = 0; n < 500 && std::isnan(value); ++n) {
    std::this_thread::sleep_for(10ms);
    value = table->latest(1).value;
  }
  EXPECT_EQ(value, 7.0);
  sources.stop();  // hung, as the reader did
  std::filesystem::remove(fifo);
  std::filesystem::remove(file);
}

TEST(ChannelSources, AValueThatCannotBeIsLeftOutAndCounted) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("ifog-limits-" + std::to_string(getpid()));
  std::ofstream(path) << "20\n";
  ChannelConfig one = config(ChannelConfig::Source::file);
  one.path = path;
  one.period_s = 0.01;
  one.limits.maximum = 85.0;
  const auto table = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, table, 0}}, kUrl);
  sources.start();
  EXPECT_EQ(await(*table, 20.0).value, 20.0);
  for (const char* bad : {"1e200", "86", "inf", "0x20", "21,5", "40 x", "+-5", "nan", "1e999", "21 22"}) {
    const std::uint64_t before = table->refused();
    std::ofstream(path) << bad << "\n";
    for (int n = 0; n < 500 && table->refused() == before; ++n) std::this_thread::sleep_for(10ms);
    EXPECT_GT(table->refused(), before) << bad;
    EXPECT_EQ(look(*table).value, 20.0) << bad;
    EXPECT_NE(table->fault(0), ChannelFault{}) << bad;
  }
  // Nothing has come: not counted, and the reason is known.
  const auto left = [&](ChannelFault::Kind kind) {
    for (int n = 0; n < 500 && table->fault(0).kind != kind; ++n) std::this_thread::sleep_for(10ms);
    return describe(one, table->fault(0));
  };
  const std::string name = "channel 'coil_degC': " + path.string();
  std::ofstream(path, std::ios::trunc).close();
  EXPECT_EQ(left(ChannelFault::Kind::empty), name + ": is empty, expected a file that holds one number");
  const std::uint64_t counted = table->refused();
  std::filesystem::remove(path);
  EXPECT_EQ(left(ChannelFault::Kind::unreadable),
            name + ": cannot read: No such file or directory, expected a file that holds one number");
  std::filesystem::create_directory(path);
  EXPECT_EQ(left(ChannelFault::Kind::no_file),
            name + ": is no regular file, expected a file that holds one number");
  std::filesystem::remove(path);
  EXPECT_EQ(table->refused(), counted);
  std::ofstream(path) << "\t+21.5\r\n";
  EXPECT_EQ(await(*table, 21.5).value, 21.5);
  EXPECT_EQ(table->fault(0), ChannelFault{});
  sources.stop();
  std::filesystem::remove(path);
}

// A wrong number that stands in the file for several reads is one reading, and agrees with nobody.
TEST(ChannelSources, TheSameWritingOfAFileIsOneReading) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("ifog-step-" + std::to_string(getpid()));
  const auto put = [&](const char* text) {
    std::ofstream(path.string() + ".new") << text << "\n";
    std::filesystem::rename(path.string() + ".new", path);
  };
  put("20");
  ChannelConfig one = config(ChannelConfig::Source::file);
  one.path = path;
  one.period_s = 0.01;
  one.limits.max_step = 5.0;
  const auto table = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, table, 0}}, kUrl);
  sources.start();
  EXPECT_EQ(await(*table, 20.0).value, 20.0);
  put("60");
  for (int n = 0; n < 500 && table->refused() == 0; ++n) std::this_thread::sleep_for(10ms);
  std::this_thread::sleep_for(100ms);  // ten more reads of it
  EXPECT_EQ(look(*table).value, 20.0);
  EXPECT_EQ(table->refused(), 1U);
  EXPECT_EQ(table->fault(0).kind, ChannelFault::Kind::impossible);
  // Written once more it is a second reading.
  put("61");
  EXPECT_EQ(await(*table, 61.0).value, 61.0);
  EXPECT_EQ(table->refused(), 1U);
  // A good one stays current, however often it is read.
  const std::int64_t time_ns = table->latest(0).time_ns;
  std::this_thread::sleep_for(50ms);
  EXPECT_GT(table->latest(0).time_ns, time_ns);
  sources.stop();
  std::filesystem::remove(path);
}

TEST(ChannelSources, ASignalOfAnotherCanFrame) {
  ChannelConfig one = config(ChannelConfig::Source::can);
  one.interface = "fake0";
  one.dbc = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/ifogd_gyro.dbc";
  one.signal = "Environment.Temperature";
  ChannelConfig other = one;
  other.signal = "Supply";
  const auto table = std::make_shared<ChannelTable>(1), supply = std::make_shared<ChannelTable>(1);
  std::vector<CanSettings> opened;
  ChannelSources sources({{one, table, 0}, {other, supply, 0}}, kUrl, [&](const CanSettings& settings) {
    opened.push_back(settings);
    // The first is the sensor's own: not this channel's.
    return std::make_unique<FakeBus>(
        std::vector{environment(256, 99.0F, 99.0F), environment(272, 36.25F, 11.5F)});
  });
  ASSERT_EQ(opened.size(), 1U);  // one socket a bus, both signals on it
  EXPECT_EQ(opened[0].interface, "fake0");
  ASSERT_EQ(opened[0].ids.size(), 2U);
  EXPECT_EQ(opened[0].ids[0].id, 272U);
  sources.start();
  EXPECT_EQ(await(*table, 36.25).value, 36.25);
  EXPECT_EQ(await(*supply, 11.5).value, 11.5);
}

// Two sensors have channels of one bus, one of them two: each is told once of what the kernel dropped, during
// the run and at its end.
TEST(ChannelSources, WhatTheKernelDropsOfAChannelsBusIsTheSensorsLoss) {
  ChannelConfig one = config(ChannelConfig::Source::can);
  one.interface = "fake0";
  one.dbc = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/ifogd_gyro.dbc";
  one.signal = "Environment.Temperature";
  ChannelConfig other = one;
  other.signal = "Supply";
  const auto first = std::make_shared<ChannelTable>(2), second = std::make_shared<ChannelTable>(1);
  ChannelSources sources(
      {{one, first, 0}, {other, first, 1}, {one, second, 0}}, kUrl, [](const CanSettings&) {
        return std::make_unique<FakeBus>(std::vector{environment(272, 36.25F, 11.5F)}, 40, 2);
      });
  sources.start();
  EXPECT_EQ(await(*second, 36.25).value, 36.25);
  while (second->drops() == 0 || first->drops() == 0) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(first->drops(), 40U);
  EXPECT_EQ(second->drops(), 40U);
  sources.stop();
  EXPECT_EQ(first->drops(), 42U);
  EXPECT_EQ(second->drops(), 42U);
}

TEST(ChannelSources, RefusesASignalThatIsNotThere) {
  ChannelConfig one = config(ChannelConfig::Source::can);
  one.dbc = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/ifogd_gyro.dbc";
  for (const auto& [signal, what] :
       {std::pair{"Pressure", "no signal \"Pressure\"; expected SIGNAL or MESSAGE.SIGNAL"},
        {"Counter", "signal \"Counter\" is in several messages; expected MESSAGE.SIGNAL"}}) {
    one.signal = signal;
    try {
      ChannelSources({{one, std::make_shared<ChannelTable>(1), 0}}, kUrl);
      ADD_FAILURE() << signal;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), one.dbc + ": " + what);
    }
  }
}

TEST(ChannelSources, AnLcmMessageOfEitherType) {
  if (const std::string why = enter_private_network(); !why.empty())
    GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
  ChannelConfig one = config(ChannelConfig::Source::lcm);
  one.lcm_channel = "HULL";
  one.scale = 2.0;
  ChannelConfig other = config(ChannelConfig::Source::lcm);
  other.lcm_channel = "IFOG_TAIL_STATUS";
  other.field = "channel_value[temperature_degC]";
  const auto hull = std::make_shared<ChannelTable>(1), tail = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, hull, 0}, {other, tail, 0}}, kUrl);
  sources.start();
  lcm_t* const lcm = lcm_create(kUrl);
  ASSERT_NE(lcm, nullptr);
  const auto send = [lcm](const char* name, const std::vector<std::uint8_t>& message) {
    lcm_publish(lcm, name, message.data(), static_cast<unsigned>(message.size()));
  };
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
  lcm_destroy(lcm);
}

// A name is a name: LCM would take it for a regular expression.
TEST(ChannelSources, AnLcmChannelIsTheOneOfThatName) {
  if (const std::string why = enter_private_network(); !why.empty())
    GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
  const std::vector<std::pair<std::string, std::string>> names = {{"HULL+1", "HULLL1"},
                                                                  {"HULL.2", "HULLx2"},
                                                                  {"(HULL)3", "HULL3"},
                                                                  {"HULL[4]", "HULL4"},
                                                                  {"HULL5$", "HULL5"}};
  for (const auto& [name, other] : names) {
    ChannelConfig one = config(ChannelConfig::Source::lcm);
    one.lcm_channel = name;
    const auto hull = std::make_shared<ChannelTable>(1);
    ChannelSources sources({{one, hull, 0}}, kUrl);
    sources.start();
    lcm_t* const lcm = lcm_create(kUrl);
    ASSERT_NE(lcm, nullptr);
    const std::vector<std::uint8_t> its = encoded(channel("coil_degC", 21.0)),
                                    others = encoded(channel("coil_degC", 99.0));
    lcm_publish(lcm, name.c_str(), its.data(), static_cast<unsigned>(its.size()));
    EXPECT_EQ(await(*hull, 21.0).value, 21.0) << name;
    lcm_publish(lcm, other.c_str(), others.data(), static_cast<unsigned>(others.size()));
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(look(*hull).value, 21.0) << other << " is heard as " << name;
    lcm_destroy(lcm);
  }
}

// By the sender's own dates, unless its clock was set back from a time that is still to come.
TEST(ChannelSources, ALateMessageNeverReplacesANewerOne) {
  if (const std::string why = enter_private_network(); !why.empty())
    GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
  ChannelConfig one = config(ChannelConfig::Source::lcm);
  one.limits.maximum = 100.0;
  one.lcm_channel = "HULL";
  const auto hull = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, hull, 0}}, kUrl);
  sources.start();
  lcm_t* const lcm = lcm_create(kUrl);
  ASSERT_NE(lcm, nullptr);
  const std::int64_t now_us = realtime_ns() / 1000, hour_us = 3'600'000'000;
  const auto send = [&](double value, std::int64_t utime) {
    channel_t message{};
    message.utime = utime;
    message.name = "coil_degC";
    message.value = value;
    const std::vector<std::uint8_t> bytes = encoded(message);
    lcm_publish(lcm, "HULL", bytes.data(), static_cast<unsigned>(bytes.size()));
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
  lcm_destroy(lcm);
}

}  // namespace
}  // namespace ifog
