// SPDX-License-Identifier: Apache-2.0
// sbgECom frames packed by hand from SBG Systems' description of the protocol; the CRCs at their ends come
// from the bit-serial definition, outside this program.
#include "drivers/host/driver_instance.h"
#include "drivers/plugins/framing/frame_finder.h"
#include "drivers/plugins/sbgecom/message.h"
#include "tests/unit/drivers/damaged_stream.h"
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

const char* const kShort =
    "FF5A 2C 00 2000"             // sync, IMU_SHORT (44), class 0, 32 bytes of data
    "001BB700 FF03"               // 12 s; every status bit but the one of the high scale
    "00001000 0000E0FF 00000800"  // 1, −2, 0.5 m/s²
    "00000004 000000FE 00000001"  // 1, −0.5, 0.25 rad/s
    "8019 2112 33";               // 25.5 °C; CRC, end
const char* const kData =
    "FF5A 03 00 3A00"             // IMU_DATA (3), 58 bytes
    "001BB700 BF03"               // 12 s; gyro y (bit 6) has failed its test
    "0000803F 00000040 00004040"  // accelerations and rates of the moment: 1, 2, 3 …
    "0000803F 00000040 00004040"  //
    "0000CC41"                    // 25.5 °C
    "0000003F 000080BF 00001C41"  // velocity increments by the interval: 0.5, −1, 9.75 m/s²
    "0000003E 000080BE 0000003F"  // angle increments by the interval: 0.125, −0.25, 0.5 rad/s
    "5BF1 33";
const char* const kHighScale =
    "FF5A 2C 00 2000 00000000 FF07 00000000 00000000 00000000 2EBFBB00 00000000 00000000 0000 AADE 33";

// As the protocol's description gives it: polynomial 0x8408, from 0, lowest bit first.
std::uint16_t by_bits(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0x8408U : crc >> 1U;
  }
  return static_cast<std::uint16_t>(crc);
}

// An IMU_SHORT that was changed, with the check that belongs to it.
Bytes checked(Bytes frame) {
  const std::uint16_t crc = by_bits(std::span(frame).subspan(2, 36));
  frame[38] = static_cast<std::uint8_t>(crc & 0xFFU);
  frame[39] = static_cast<std::uint8_t>(crc >> 8U);
  return frame;
}

TEST(SbgEcom, ImuShortPackedByHand) {
  DriverInstance driver = make_driver("sbgecom", {});
  const ifog_sample s = one_sample(driver, hex_bytes(kShort));
  EXPECT_EQ(s.flags, unsigned{IFOG_SAMPLE_DEVICE_TIME});
  EXPECT_EQ(s.device_time_ns, 12'000'000'000);
  EXPECT_EQ(s.device_wrap_ns, (std::int64_t{1} << 32U) * 1000);
  EXPECT_EQ(s.status, 0x3FFU);
  EXPECT_EQ(s.valid_axes, 7U);
  expect_numbers(s.value, {1.0, -0.5, 0.25});
  EXPECT_EQ(s.environment_fresh, 0b1111U);
  expect_numbers(s.environment, {1.0, -2.0, 0.5, 25.5});
}

TEST(SbgEcom, ImuDataPackedByHandGivesTheIncrements) {
  DriverInstance driver = make_driver("sbgecom", {});
  const ifog_sample s = one_sample(driver, hex_bytes(kData));
  EXPECT_EQ(s.valid_axes, 0b101U);
  expect_numbers(s.value, {0.125, -0.25, 0.5});
  expect_numbers(s.environment, {0.5, -1.0, 9.75, 25.5});
}

TEST(SbgEcom, TheHighScaleIsTheStatusBits) {
  DriverInstance driver = make_driver("sbgecom", {});
  EXPECT_EQ(decoded(driver, hex_bytes(kHighScale)).at(0).value[0], 1.0);
  // 40 rad/s do not fit into the standard scale: the encoder goes over to the high one.
  ifog_sample sample{};
  sample.flags = IFOG_SAMPLE_DEVICE_TIME;
  sample.valid_axes = 7;
  sample.value[1] = -40.0;
  Bytes bytes;
  driver.encode_bytes(sample, bytes);
  const ifog_sample s = one_sample(driver, bytes);
  EXPECT_EQ(s.status & 0x400U, 0x400U);
  EXPECT_NEAR(s.value[1], -40.0, 1.0 / 12304174.0);
  sample.value[1] = 200.0;
  EXPECT_THROW(driver.encode_bytes(sample, bytes), std::runtime_error);
}

TEST(SbgEcom, StatusBitsInvalidate) {
  DriverInstance driver = make_driver("sbgecom", {});
  for (const auto& [status, valid, fresh] : {std::tuple{0x3FE, 0U, 0U},    // no communication with the IMU
                                             {0x1FF, 0U, 0b1111U},         // a gyro out of range
                                             {0x2FF, 7U, 0b1000U},         // an accelerometer out of range
                                             {0x3DF, 0b110U, 0b1111U}}) {  // gyro x
    Bytes frame = hex_bytes(kShort);
    frame[10] = static_cast<std::uint8_t>(status & 0xFF);
    frame[11] = static_cast<std::uint8_t>(status >> 8);
    const ifog_sample s = one_sample(driver, checked(frame));
    EXPECT_EQ(s.valid_axes, valid) << status;
    EXPECT_EQ(s.environment_fresh, fresh) << status;
  }
}

TEST(SbgEcom, OneOfTwoLogsIsChosen) {
  Bytes both = hex_bytes(kShort);
  const Bytes data = hex_bytes(kData);
  both.insert(both.end(), data.begin(), data.end());
  DriverInstance brief = make_driver("sbgecom", {{"message", "imu_short"}});
  EXPECT_EQ(decoded(brief, both).size(), 1U);
  EXPECT_EQ(brief.counters().frames_good, 2U);
  EXPECT_EQ(brief.counters().bytes_skipped, 0U);
}

// The two sync bytes, the class and the length of an IMU_SHORT, all by chance in its own values.
TEST(SbgEcom, AHeaderAmongTheValuesIsNoFrame) {
  Bytes frame = hex_bytes(kShort);
  const Bytes header = hex_bytes("FF5A 01 00 0100");
  std::copy(header.begin(), header.end(), frame.begin() + 13);
  frame = checked(frame);
  for (const std::size_t portion : {std::size_t{1}, std::size_t{7}, std::size_t{123}}) {
    Bytes stream;
    for (int i = 0; i < 3; ++i) stream.insert(stream.end(), frame.begin(), frame.end());
    stream[41 + 20] ^= 1U;  // of the second, which so is none, and what looks like a header in it is one
    DriverInstance driver = make_driver("sbgecom", {});
    EXPECT_EQ(decoded(driver, stream, 0, portion).size(), 2U);
    EXPECT_EQ(driver.counters().frames_crc, 2U) << portion;
    EXPECT_EQ(driver.counters().bytes_skipped, frame.size()) << portion;
  }
}

TEST(SbgEcom, EncodesTheHandPackedFrameAgain) {
  DriverInstance driver = make_driver("sbgecom", {});
  const Bytes bytes = hex_bytes(kShort);
  Bytes again;
  driver.encode_bytes(decoded(driver, bytes).at(0), again);
  EXPECT_EQ(again, bytes);
}

Bytes framed(std::uint8_t message, std::uint8_t kind, const Bytes& data) {
  Bytes out{0xFF,
            0x5A,
            message,
            kind,
            static_cast<std::uint8_t>(data.size() & 0xFFU),
            static_cast<std::uint8_t>(data.size() >> 8U)};
  out.insert(out.end(), data.begin(), data.end());
  const std::uint16_t crc = by_bits(std::span(out).subspan(2));
  out.insert(out.end(), {static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8U), 0x33});
  return out;
}

TEST(SbgEcom, EveryIntactFrameComesOutOfADamagedStream) {
  constexpr std::uint8_t kClasses[] = {0, 1, 2, 3, 4, 5, 0x10, 0x90};
  Random random(9);
  std::vector<Bytes> frames;
  while (frames.size() < 200) {
    const auto which = random() % 3;
    const std::uint8_t message = which == 0   ? 44
                                 : which == 1 ? 3
                                              : static_cast<std::uint8_t>(4 + random() % 36);
    const std::uint8_t kind = which < 2 ? std::uint8_t{0} : kClasses[random() % 8];
    Bytes data;
    const std::size_t length = which == 0 ? 32 : which == 1 ? 58 : random() % 200;
    while (data.size() < length) {
      data.push_back(static_cast<std::uint8_t>(random()));
      if (random() % 64 == 0 && data.size() + 2 <= length) data.insert(data.end(), {0xFF, 0x5A});
    }
    frames.push_back(framed(message, kind, data));
  }
  every_intact_frame_comes_out(frames, 100, sbgecom::Protocol{});
}

}  // namespace
}  // namespace ifog
