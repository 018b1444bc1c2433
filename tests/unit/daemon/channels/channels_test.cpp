// SPDX-License-Identifier: Apache-2.0
// Environment channels from a file or another CAN frame.
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/channels/can_channel.h"
#include "daemon/channels/channel_sources.h"
#include "daemon/channels/channel_watch.h"
#include "drivers/transport/clock.h"
#include "tests/unit/daemon/channels/awaited.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

ChannelConfig config(ChannelConfig::Source source) {
  ChannelConfig out;
  out.name = "coil_degC";
  out.source = source;
  return out;
}

// A channel that reads a file of its own a hundred times a second.
class FileChannel : public testing::Test, protected test::OwnFolder {
 protected:
  FileChannel() {
    one.path = path("value");
    one.period_s = 0.01;
  }
  ~FileChannel() override {
    if (sources_) sources_->stop();
  }
  void start() {
    sources_ = std::make_unique<ChannelSources>(std::vector{ChannelSources::Wanted{one, table, 0}}, kUrl);
    sources_->start();
  }
  // Half-written files are seen by nobody.
  void put(const std::string& text) const {
    write("new", text);
    std::filesystem::rename(path("new"), one.path);
  }

  ChannelConfig one = config(ChannelConfig::Source::file);
  std::shared_ptr<ChannelTable> table = std::make_shared<ChannelTable>(1);

 private:
  std::unique_ptr<ChannelSources> sources_;
};

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
    if (out.empty()) waiting_.wait(-1, 0, until_ns);
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

// From the unit that the file states to the one of the channel's name, unless a scale is configured.
TEST(CanChannel, HasTheUnitOfItsName) {
  const test::OwnFolder folder;
  folder.write("bus.dbc", "BO_ 1 A: 8 X\n SG_ T : 0|16@1- (0.1,0) [0|0] \"degF\" X\n");
  ifog_can_frame frame{};
  frame.id = 1;
  frame.length = 8;
  frame.data[0] = 0xC3;  // 707
  frame.data[1] = 0x02;
  const auto value = [&](const char* name, double scale) {
    ChannelConfig channel = config(ChannelConfig::Source::can);
    channel.name = name;
    channel.dbc = folder.path("bus.dbc");
    channel.signal = "T";
    channel.scale = scale;
    const CanChannel read(channel);
    double out = NAN;
    EXPECT_TRUE(read.decode(frame, out));
    EXPECT_EQ(read.remark().empty(), channel.name != "coil_V") << read.remark();
    return out;
  };
  EXPECT_NEAR(value("coil_degC", 1.0), 21.5, 1e-9);
  EXPECT_NEAR(value("coil_degC", 0.5), 70.7, 1e-9);  // what scale and offset then apply to
  EXPECT_NEAR(value("coil_V", 1.0), 70.7, 1e-9);
}

TEST_F(FileChannel, AValueThatCannotBeIsLeftOutAndCounted) {
  put("20\n");
  one.limits.maximum = 85.0;
  one.scale = 2.0;
  one.offset = -20.0;
  EXPECT_TRUE(std::isnan(look(*table).value));
  EXPECT_TRUE(std::isinf(look(*table).age_s));
  start();
  EXPECT_EQ(await(*table, 20.0).value, 20.0);
  EXPECT_LT(look(*table).age_s, 60.0F);
  for (const char* bad : {"1e200", "86", "inf", "0x20", "21,5", "40 x", "+-5", "nan", "1e999", "21 22"}) {
    const std::uint64_t before = table->refused();
    put(std::string(bad) + "\n");
    for (int n = 0; n < 500 && table->refused() == before; ++n) std::this_thread::sleep_for(10ms);
    EXPECT_GT(table->refused(), before) << bad;
    EXPECT_EQ(look(*table).value, 20.0) << bad;
    EXPECT_NE(table->fault(0), ChannelFault{}) << bad;
  }
  // The last value stays, and grows old.
  const float age_s = look(*table).age_s;
  std::this_thread::sleep_for(50ms);
  EXPECT_GT(look(*table).age_s, age_s);
  // Nothing has come: not counted, and the reason is known.
  const auto left = [&](ChannelFault::Kind kind) {
    for (int n = 0; n < 500 && table->fault(0).kind != kind; ++n) std::this_thread::sleep_for(10ms);
    return describe(one, table->fault(0));
  };
  const std::string name = "channel 'coil_degC': " + one.path;
  put("");
  EXPECT_EQ(left(ChannelFault::Kind::empty), name + ": is empty, expected a file that holds one number");
  const std::uint64_t counted = table->refused();
  std::filesystem::remove(one.path);
  // Nobody writes into it: reading it would wait for ever.
  ASSERT_EQ(mkfifo(one.path.c_str(), 0600), 0);
  EXPECT_EQ(left(ChannelFault::Kind::no_file),
            name + ": is no regular file, expected a file that holds one number");
  std::filesystem::remove(one.path);
  EXPECT_EQ(left(ChannelFault::Kind::unreadable),
            name + ": cannot read: No such file or directory, expected a file that holds one number");
  std::filesystem::create_directory(one.path);
  EXPECT_EQ(left(ChannelFault::Kind::no_file),
            name + ": is no regular file, expected a file that holds one number");
  std::filesystem::remove(one.path);
  EXPECT_EQ(table->refused(), counted);
  put("\t+21.5\r\n");
  EXPECT_EQ(await(*table, 23.0).value, 23.0);
  EXPECT_EQ(table->fault(0), ChannelFault{});
}

// A wrong number that stands in the file for several reads is one reading, and agrees with nobody.
TEST_F(FileChannel, TheSameWritingIsOneReading) {
  put("20\n");
  one.limits.max_step = 5.0;
  start();
  EXPECT_EQ(await(*table, 20.0).value, 20.0);
  put("60\n");
  for (int n = 0; n < 500 && table->refused() == 0; ++n) std::this_thread::sleep_for(10ms);
  std::this_thread::sleep_for(100ms);  // ten more reads of it
  EXPECT_EQ(look(*table).value, 20.0);
  EXPECT_EQ(table->refused(), 1U);
  EXPECT_EQ(table->fault(0).kind, ChannelFault::Kind::impossible);
  // Written once more it is a second reading.
  put("61\n");
  EXPECT_EQ(await(*table, 61.0).value, 61.0);
  EXPECT_EQ(table->refused(), 1U);
  // A good one stays current, however often it is read.
  const std::int64_t time_ns = table->latest(0).time_ns;
  std::this_thread::sleep_for(50ms);
  EXPECT_GT(table->latest(0).time_ns, time_ns);
}

ChannelConfig can_signal(const std::string& signal) {
  ChannelConfig out = config(ChannelConfig::Source::can);
  out.interface = "fake0";
  out.dbc = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/ifogd_gyro.dbc";
  out.signal = signal;
  return out;
}

TEST(ChannelSources, ASignalOfAnotherCanFrame) {
  const ChannelConfig one = can_signal("Environment.Temperature"), other = can_signal("Supply");
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
  const ChannelConfig one = can_signal("Environment.Temperature"), other = can_signal("Supply");
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
  for (const auto& [signal, what] :
       {std::pair{"Pressure", "no signal \"Pressure\"; expected SIGNAL or MESSAGE.SIGNAL"},
        {"Counter", "signal \"Counter\" is in several messages; expected MESSAGE.SIGNAL"}}) {
    const ChannelConfig one = can_signal(signal);
    EXPECT_EQ(test::refusal([&] {
                ChannelSources({{one, std::make_shared<ChannelTable>(1), 0}}, kUrl);
              }),
              one.dbc + ": " + what);
  }
}

}  // namespace
}  // namespace ifog
