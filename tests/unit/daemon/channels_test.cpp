// Environment channels from outside a sensor's own frames: a file, an LCM message, another CAN frame.
#include "daemon/channels/channel_sources.h"

#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <sys/stat.h>
#include <unistd.h>

#include <ifog/decode.h>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "daemon/channels/lcm_field.h"
#include "drivers/transport/clock.h"
#include "tests/unit/daemon/private_network.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;
constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return out;
}

channel_t channel(const std::string& name, double value, std::int64_t utime = 0) {
  channel_t out{};
  out.name = name;
  out.value = value;
  out.utime = utime;
  return out;
}

// Two axes, each field with numbers of its own.
rate_t rate() {
  rate_t out{};
  out.utime = 7;
  out.axes = 2;
  double next = 0.0;
  for (auto* field : {&out.raw, &out.compensated, &out.denoised, &out.variance, &out.delta_theta,
                      &out.covered, &out.angle, &out.innovation, &out.innovation_variance, &out.gain})
    for (int axis = 0; axis < 2; ++axis) field->push_back(++next);
  return out;
}

status_t status() {
  status_t out{};
  out.utime = 5'000'000;
  out.clock_offset_ppm = -12.5;
  out.latency_p99_us = 88.0;
  out.axes = 1;
  out.nis_mean = {1.1};
  out.whiteness = {0.2};
  out.measurement_noise = {3e-9};
  out.channels = 2;
  out.channel_name = {"supply_V", "temperature_degC"};
  out.channel_value = {12.0, 41.5};
  out.channel_age_s = {INFINITY, 2.0};
  out.allan_rate_radps.resize(1);
  return out;
}

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

TEST(LcmField, RefusesBracketsItDoesNotKnow) {
  for (const char* text :
       {"raw[3]", "raw[x]", "raw[0", "angle[0]", "channel_value[]", "clock_offset_ppm[0]"}) {
    try {
      LcmField{text};
      ADD_FAILURE() << text << " was accepted";
    } catch (const std::runtime_error& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.rfind("sensor.channel.field = \"" + std::string(text) + "\": expected ", 0), 0U) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos);
    }
  }
}

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
  void count_losses() noexcept override { kernel_drops_.add(std::exchange(last_, 0)); }
  Delivery receive(std::int64_t until_ns) noexcept override {
    Delivery out;
    kernel_drops_.add(std::exchange(drops_, 0));
    out.frames = std::exchange(given_, true) ? std::span<const ifog_can_frame>() : frames_;
    short happened = 0;
    if (out.empty()) wait(-1, 0, until_ns, happened);
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
  for (const char* bad : {"1e200", "86", "inf"}) {
    const std::uint64_t before = table->refused();
    std::ofstream(path) << bad << "\n";
    for (int n = 0; n < 500 && table->refused() == before; ++n) std::this_thread::sleep_for(10ms);
    EXPECT_GT(table->refused(), before) << bad;
    EXPECT_EQ(look(*table).value, 20.0) << bad;
  }
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

}  // namespace
}  // namespace ifog
