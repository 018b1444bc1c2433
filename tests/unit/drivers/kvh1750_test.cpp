// SPDX-License-Identifier: Apache-2.0
// The frame layout against bytes that our encoder did not make: the standard's check value and frames packed
// by hand from the maker's description, the CRC by the bit-serial definition.
#include "drivers/host/driver_instance.h"
#include "drivers/plugins/kvh1750/frame.h"
#include "tests/unit/drivers/damaged_stream.h"
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace {

// Frames packed by hand from the tables of the maker's manual; the CRCs at their ends come from long division
// done outside this program.

//                                 header    gyro 1, -2, 0.5             accelerometer 0, 1, -1      st sq 25
//                                 CRC
const char* const kFrameA =
    "FE81FF55 3F800000 C0000000 3F000000 00000000 3F800000 BF800000 77 05 0019 F6EB3358";
//                                           0.1      -0.1     NaN       3.1415927, 0, -1       12 s     st sq
//                                           -10
const char* const kFrameB =
    "FE81FF56 3DCCCCCD BDCCCCCD 7FC00000 40490FDB 00000000 BF800000 00B71B00 73 7F FFF6 3736CF8E";
//                                                                                              0.49 gauss, y
const char* const kFrameC =
    "FE81FF57 3F800000 C0000000 3F000000 00000000 3F800000 BF800000 3EFAE148 77 06 DCB3C67E";

TEST(Kvh1750, FormatAPackedByHand) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {});
  const ifog_sample s = ifog::one_sample(driver, ifog::hex_bytes(kFrameA));
  EXPECT_EQ(s.arrival_ns, 42);
  EXPECT_EQ(s.flags, IFOG_SAMPLE_SEQUENCE);
  EXPECT_EQ(s.sequence, 5U);
  EXPECT_EQ(s.status, 0x77U);
  EXPECT_EQ(s.valid_axes, 7U);
  ifog::expect_numbers(s.value, {1.0, -2.0, 0.5});
  EXPECT_EQ(s.environment_fresh, 0b1111U);
  ifog::expect_numbers(s.environment, {0.0, 9.80665, -9.80665, 25.0, NAN});
}

// The sample output printed in the maker's 1775 IMU technical manual (section 5.2.1), which also breaks it
// down: delta angles in radians, about −1 g along x, all valid, sequence 61, 40 °C.
TEST(Kvh1750, TheManualsSampleOutput) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"output", "delta"}});
  const std::vector<ifog_sample> samples = ifog::decoded(
      driver,
      ifog::hex_bytes("FE81FF55 37A96A6E 38586C1F B75BF862 BF803E78 BB650D28 3B0A37AC 77 3D 0028 4BFA34D8"));
  ASSERT_EQ(samples.size(), 1U);
  const ifog_sample& s = samples[0];
  EXPECT_EQ(driver.description().kind, unsigned{IFOG_DELTA_ANGLE});
  ifog::expect_numbers(s.value, {2.019593e-5, 5.159911e-5, -1.311125e-5}, 1e-11);
  EXPECT_NEAR(s.environment[0], -1.0019064 * 9.80665, 1e-6);
  EXPECT_EQ(s.valid_axes, 7U);
  EXPECT_EQ(s.sequence, 61U);
  EXPECT_EQ(s.environment[3], 40.0);
}

TEST(Kvh1750, FormatBPackedByHand) {
  ifog::DriverInstance driver = ifog::make_driver(
      "kvh1750", {{"format", "b"}, {"angle_unit", "degrees"}, {"temperature", "centi_degC"}});
  const ifog_sample s = ifog::one_sample(driver, ifog::hex_bytes(kFrameB));
  EXPECT_EQ(s.flags, unsigned{IFOG_SAMPLE_SEQUENCE | IFOG_SAMPLE_DEVICE_TIME});
  EXPECT_EQ(s.device_time_ns, 12'000'000'000);
  EXPECT_EQ(s.sequence, 127U);
  // 0x73: the device calls gyro z invalid, and it is no number either.
  EXPECT_EQ(s.valid_axes, 0b011U);
  EXPECT_DOUBLE_EQ(s.value[0], static_cast<double>(0.1F) * 3.14159265358979323846 / 180.0);
  EXPECT_NEAR(s.environment[0], 3.14159265 * 9.80665, 1e-6);
  EXPECT_DOUBLE_EQ(s.environment[3], -0.1);
}

TEST(Kvh1750, FormatCPackedByHand) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", "c"}});
  const ifog_sample s = ifog::one_sample(driver, ifog::hex_bytes(kFrameC));
  EXPECT_EQ(s.sequence, 6U);  // modulo four: 2, the field along y
  EXPECT_EQ(s.environment_fresh, 0b0100111U);
  EXPECT_NEAR(s.environment[5], 49.0, 1e-5);  // µT
  EXPECT_TRUE(std::isnan(s.environment[3]));
  EXPECT_TRUE(std::isnan(s.environment[4]));
}

TEST(Kvh1750, AnInvalidStatusBitInvalidatesItsAxisOnly) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {});
  std::vector<std::uint8_t> frame = ifog::hex_bytes(kFrameA);
  frame.resize(32);
  frame[28] = 0x25;  // gyro x and z, accelerometer y
  ifog::append_crc32(frame);
  const ifog_sample s = ifog::one_sample(driver, frame);
  EXPECT_EQ(s.valid_axes, 0b101U);
  EXPECT_EQ(s.environment_fresh, 0b1010U);
}

TEST(Kvh1750, AnotherFormatThanConfiguredIsCountedNotTaken) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", "a"}});
  EXPECT_TRUE(ifog::decoded(driver, ifog::hex_bytes(kFrameB)).empty());
  EXPECT_EQ(ifog::decoded(driver, ifog::hex_bytes(kFrameA)).size(), 1U);
  EXPECT_EQ(driver.counters().frames_format, 1U);
  EXPECT_EQ(driver.counters().frames_good, 1U);
  EXPECT_EQ(driver.counters().bytes_skipped, 0U);
}

TEST(Kvh1750, TheStampRollsOverAsTheDeviceIsSet) {
  for (const auto& [set, wrap_ns] :
       {std::pair("free", (std::int64_t{1} << 32U) * 1000), std::pair("pps", std::int64_t{1'000'000'000})}) {
    ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", "b"}, {"time_stamp", set}});
    EXPECT_EQ(ifog::one_sample(driver, ifog::hex_bytes(kFrameB)).device_wrap_ns, wrap_ns);
  }
}

// Every intact frame is recovered from a damaged stream.

TEST(Kvh1750, EveryIntactFrameComesOutOfADamagedStream) {
  ifog::Random random(9);
  std::vector<ifog::Bytes> frames(200);
  for (ifog::Bytes& frame : frames) {
    const auto header = [&] {
      const ifog::Bytes out{0xFE, 0x81, 0xFF, static_cast<std::uint8_t>(0x55 + random() % 3)};
      frame.insert(frame.end(), out.begin(), out.end());
    };
    header();
    const std::size_t covered = frame[3] == 0x55 ? 32 : frame[3] == 0x56 ? 36 : 34;
    while (frame.size() < covered) {
      // One payload in four holds a header.
      if (frame.size() + 4 <= covered && random() % 32 == 0)
        header();
      else
        frame.push_back(static_cast<std::uint8_t>(random() % 256));
    }
    ifog::append_crc32(frame);
  }
  ifog::every_intact_frame_comes_out(frames, 300, ifog::kvh::Protocol{});
}

// The encoder against the decoder, which the tests above hold to the manual.

TEST(Kvh1750, EncodesTheHandPackedFramesAgain) {
  for (const auto& [format, text] : {std::pair{"a", kFrameA}, {"b", kFrameB}}) {
    ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", format}});
    const std::vector<std::uint8_t> bytes = ifog::hex_bytes(text);
    std::vector<std::uint8_t> again;
    driver.encode_bytes(ifog::decoded(driver, bytes).at(0), again);
    EXPECT_EQ(again, bytes) << format;
  }
}

TEST(Kvh1750, EncodeRefusesWhatTheFormatCannotHold) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"temperature", "centi_degC"}});
  ifog_sample sample{};
  sample.environment[3] = 400.0;
  std::vector<std::uint8_t> bytes;
  EXPECT_EQ(ifog::test::refusal([&] { driver.encode_bytes(sample, bytes); }),
            "driver kvh1750: temperature_degC is 400.000000, expected what 16 bits hold in the temperature "
            "option's scale");
  EXPECT_TRUE(bytes.empty());
}

}  // namespace
