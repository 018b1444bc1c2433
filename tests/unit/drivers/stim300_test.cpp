// SPDX-License-Identifier: Apache-2.0
// STIM300 datagrams packed by hand from the tables of the maker's datasheet (TS1524 rev. 31); the CRCs at
// their ends come from long division done outside this program.
#include "drivers/host/driver_instance.h"
#include "drivers/plugins/framing/frame_finder.h"
#include "drivers/plugins/stim300/datagram.h"
#include "tests/unit/drivers/damaged_stream.h"
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

const char* const kA7 =
    "A7"                       // rate, acceleration, inclination and temperature
    "004000 FF6000 002000 00"  // gyro: 1, −2.5, 0.5 °/s; status
    "080000 FC0000 000000 00"  // accelerometer of 10 g: 1, −0.5, 0 g; status
    "400000 000000 C00000 00"  // inclinometer: 1, 0, −1 g; status
    "1980 F5C0 0000 00"        // gyro temperatures: 25.5, −10.25, 0 °C; status
    "1E00 1F00 2000 00"        // accelerometer temperatures: 30, 31, 32 °C; status
    "1400 1500 1600 00"        // inclinometer temperatures: 20, 21, 22 °C; status
    "0A 0204 6E6DE96F";        // counter 10, latency 516 µs, CRC (with one dummy byte)
const char* const k90 = "90 200000 E00000 000001 14 FE 0010 E9BEC564";  // rates alone, two dummy bytes
const char* const kF1 =
    "F1 004000 000000 000000 00 080000 080000 080000 00"
    "000264 00 04 0100 DF9CF924";  // PPS 612 µs and its status; counter 4, latency 256; no dummy byte

// Section 5.5.7 of the datasheet: the CRC is of the bytes and of the dummy bytes behind them.
void append_crc(Bytes& bytes) { append_crc32(bytes, 4); }

TEST(Stim300, ADatagramPackedByHand) {
  DriverInstance driver = make_driver("stim300", {{"rate_hz", "1000"}});
  const ifog_sample s = one_sample(driver, hex_bytes(kA7));
  EXPECT_EQ(s.arrival_ns, 42);
  EXPECT_EQ(s.flags, unsigned{IFOG_SAMPLE_SEQUENCE});
  EXPECT_EQ(s.sequence, 5U);  // two internal samples each
  EXPECT_EQ(driver.description().sequence_modulus, 128U);
  EXPECT_EQ(s.valid_axes, 7U);
  expect_numbers(s.value, {1.0 * kDegree, -2.5 * kDegree, 0.5 * kDegree});
  expect_numbers(s.environment, {9.80665, -4.903325, 0.0, 9.80665, 0.0, -9.80665, 25.5, -10.25, 0.0, 30.0,
                                 31.0, 32.0, 21.0, 516.0, NAN, NAN});
  EXPECT_EQ(s.environment_fresh, 0x3FFFU);
  EXPECT_NEAR(driver.description().full_scale[0], 400 * kDegree, 1e-12);
}

// The first is the datasheet's example of an error (figure 9-2): overload of the z-channel, bits 4 and 2.
TEST(Stim300, StatusBitsInvalidate) {
  DriverInstance driver = make_driver("stim300", {});
  for (const auto& [status, valid] : {std::pair{0x14, 0b011U},
                                      {0x80, 0U},
                                      {0x40, 0U},
                                      {0x20, 7U},
                                      {0x0A, 0b101U},
                                      {0x08, 0U},
                                      {0x0F, 0U}}) {
    Bytes datagram = hex_bytes(k90);
    datagram.resize(datagram.size() - 4);
    datagram[10] = static_cast<std::uint8_t>(status);
    append_crc(datagram);
    const ifog_sample s = one_sample(driver, datagram);
    EXPECT_EQ(s.valid_axes, valid) << status;
    EXPECT_EQ(s.status, static_cast<std::uint32_t>(status));
    expect_numbers(s.value, {128 * kDegree, -128 * kDegree, kDegree / 16384});
    EXPECT_EQ(s.sequence, 254U);
  }
}

TEST(Stim300, PpsAndLatency) {
  DriverInstance driver = make_driver("stim300", {{"datagram", "0xF1"}, {"rate_hz", "500"}});
  const ifog_sample s = one_sample(driver, hex_bytes(kF1));
  EXPECT_EQ(s.environment[14], 612.0);
  EXPECT_EQ(s.environment[13], 256.0);
  EXPECT_EQ(s.sequence, 1U);
}

TEST(Stim300, IncrementalAndIntegratedAngles) {
  DriverInstance increments = make_driver("stim300", {{"output", "incremental_angle"}});
  EXPECT_EQ(increments.description().kind, unsigned{IFOG_DELTA_ANGLE});
  EXPECT_DOUBLE_EQ(decoded(increments, hex_bytes(k90)).at(0).value[0], kDegree);  // 2^21 counts
  DriverInstance angle = make_driver("stim300", {{"output", "integrated_angle"}});
  EXPECT_EQ(angle.description().kind, unsigned{IFOG_ANGLE});
  EXPECT_DOUBLE_EQ(angle.description().angle_wrap_rad, 8 * kDegree);
  // An angle of 5° is sent as −3°.
  ifog_sample sample{};
  sample.valid_axes = 7;
  sample.value[0] = 5 * kDegree;
  Bytes bytes;
  angle.encode_bytes(sample, bytes);
  EXPECT_NEAR(decoded(angle, bytes).at(0).value[0], -3 * kDegree, 1e-8);
}

TEST(Stim300, VelocityIncrementsBecomeSpecificForce) {
  DriverInstance driver = make_driver(
      "stim300", {{"acceleration", "delta_velocity"}, {"acceleration_range", "30"}, {"rate_hz", "250"}});
  // Equation 4 for 30 g: 2^21 counts are 1 m/s; 2^19 of them in 4 ms are 62.5 m/s².
  EXPECT_DOUBLE_EQ(decoded(driver, hex_bytes(kA7)).at(0).environment[0], 62.5);
  // Equation 6: 2^25 counts are 1 m/s.
  EXPECT_DOUBLE_EQ(decoded(driver, hex_bytes(kA7)).at(0).environment[3], 31.25);
}

TEST(Stim300, AnotherDatagramThanConfiguredIsCountedNotTaken) {
  DriverInstance driver = make_driver("stim300", {{"datagram", "0xA7"}});
  EXPECT_TRUE(decoded(driver, hex_bytes(k90)).empty());
  EXPECT_EQ(decoded(driver, hex_bytes(kA7)).size(), 1U);
  EXPECT_EQ(driver.counters().frames_format, 1U);
  EXPECT_EQ(driver.counters().frames_good, 1U);
}

TEST(Stim300, TheTerminationBelongsToTheDatagram) {
  DriverInstance driver = make_driver("stim300", {{"termination", "crlf"}});
  Bytes bytes = hex_bytes(kA7);
  const std::size_t length = bytes.size();
  bytes.insert(bytes.end(), {'\r', '\n'});
  EXPECT_EQ(decoded(driver, bytes).size(), 1U);
  EXPECT_EQ(driver.counters().bytes_framed, length + 2);
  EXPECT_EQ(driver.counters().bytes_skipped + driver.counters().bytes_pending, 0U);
}

TEST(Stim300, EncodesTheHandPackedDatagramsAgain) {
  for (const auto& [datagram, text] : {std::pair{"0xA7", kA7}, {"0xF1", kF1}}) {
    DriverInstance driver = make_driver("stim300", {{"datagram", datagram}, {"rate_hz", "1000"}});
    const Bytes bytes = hex_bytes(text);
    Bytes again;
    ifog_sample sample = decoded(driver, bytes).at(0);
    driver.encode_bytes(sample, again);
    // Three temperatures of the inclinometer are passed on as their mean.
    if (bytes[0] == 0xA7) {
      EXPECT_EQ(hex_bytes("1500 1500 1500"), Bytes(again.begin() + 45, again.begin() + 51));
      again = Bytes(again.begin(), again.begin() + 45);
      EXPECT_EQ(again, Bytes(bytes.begin(), bytes.begin() + 45));
    } else {
      EXPECT_EQ(again, bytes);
    }
  }
}

TEST(Stim300, RefusesInOneLine) {
  EXPECT_TRUE(test::has(refusal("stim300", {{"datagram", "0xBC"}}),
                        "datagram is '0xBC', expected auto or the identifier"));
  EXPECT_TRUE(test::has(refusal("stim300", {{"rate_hz", "300"}}), "rate_hz is '300'"));
  DriverInstance driver = make_driver("stim300", {});
  ifog_sample sample{};
  sample.valid_axes = 1;
  sample.value[0] = 600 * kDegree;
  Bytes bytes;
  EXPECT_THROW(driver.encode_bytes(sample, bytes), std::runtime_error);
  EXPECT_TRUE(bytes.empty());
}

// Identifier, and bytes before the CRC: tables 5-20 and 5-21 added up by hand.
constexpr std::pair<int, std::size_t> kLengths[] = {
    {0x90, 14}, {0x91, 24}, {0x92, 24}, {0x93, 34}, {0x94, 21}, {0xA5, 38}, {0xA6, 38}, {0xA7, 55},
    {0xF0, 18}, {0xF1, 28}, {0xF2, 28}, {0xF3, 38}, {0xF4, 25}, {0xF5, 42}, {0xF6, 42}, {0xF7, 59},
    {0x98, 18}, {0x99, 28}, {0x9A, 28}, {0x9B, 38}, {0x9C, 25}, {0xAD, 42}, {0xAE, 42}, {0xAF, 59}};

// The longest has 63 bytes: PPS or AUX, and all temperatures.
TEST(Stim300, EncodesEveryDatagramThereIs) {
  for (const auto& [id, covered] : kLengths) {
    std::array<char, 8> name{};
    std::snprintf(name.data(), name.size(), "0x%02X", static_cast<unsigned>(id));
    for (const bool terminated : {false, true}) {
      DriverInstance driver =
          make_driver("stim300", {{"datagram", name.data()}, {"termination", terminated ? "crlf" : "none"}});
      ifog_sample sample{};
      sample.valid_axes = 7;
      for (std::size_t axis = 0; axis < 3; ++axis)
        sample.value[axis] = static_cast<double>(axis + 1) * kDegree;
      Bytes bytes;
      driver.encode_bytes(sample, bytes);
      ASSERT_EQ(bytes.size(), covered + 4 + (terminated ? 2U : 0U)) << name.data();
      Bytes again(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(covered));
      append_crc(again);
      EXPECT_TRUE(std::equal(again.begin(), again.end(), bytes.begin())) << name.data();
      const ifog_sample s = one_sample(driver, bytes);
      EXPECT_NEAR(s.value[2], 3 * kDegree, 1e-6) << name.data();
    }
  }
}

// No device sends this; but what a line gave byte by byte its recording gives again, read at once.
TEST(Stim300, ADatagramInsideAnotherIsTheSameHoweverItComes) {
  Bytes outer{0xA7};
  const Bytes inner = hex_bytes(k90);
  outer.insert(outer.end(), 5, std::uint8_t{0});
  outer.insert(outer.end(), inner.begin(), inner.end());
  outer.resize(55);
  append_crc(outer);
  DriverInstance whole = make_driver("stim300", {}), bytewise = make_driver("stim300", {});
  const std::vector<ifog_sample> at_once = decoded(whole, outer);
  std::vector<ifog_sample> one_by_one;
  for (const std::uint8_t byte : outer)
    for (const ifog_sample& sample : decoded(bytewise, {&byte, 1})) one_by_one.push_back(sample);
  ASSERT_EQ(at_once.size(), 1U);
  ASSERT_EQ(one_by_one.size(), 1U);
  EXPECT_DOUBLE_EQ(at_once[0].value[0], one_by_one[0].value[0]);
  EXPECT_EQ(whole.counters().bytes_skipped, bytewise.counters().bytes_skipped);
  EXPECT_EQ(whole.counters().bytes_framed, inner.size());
}

TEST(Stim300, EveryIntactDatagramComesOutOfADamagedStream) {
  for (const bool terminated : {false, true}) {
    Random random(9);
    std::vector<Bytes> datagrams;
    for (int i = 0; i < 240; ++i) {
      const auto& [id, covered] = kLengths[i % 24];
      Bytes& out = datagrams.emplace_back(1, static_cast<std::uint8_t>(id));
      while (out.size() < covered) out.push_back(static_cast<std::uint8_t>(random() % 256));
      append_crc(out);
      if (terminated) out.insert(out.end(), {'\r', '\n'});
    }
    every_intact_frame_comes_out(datagrams, 100, stim300::Protocol{terminated});
  }
}

}  // namespace
}  // namespace ifog
