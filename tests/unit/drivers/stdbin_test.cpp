// SPDX-License-Identifier: Apache-2.0
// STDBIN telegrams packed by hand from iXblue's description of the protocol, their sums added up outside this
// program.
#include "drivers/host/driver_instance.h"
#include "drivers/plugins/framing/frame_finder.h"
#include "drivers/plugins/stdbin/telegram.h"
#include "tests/unit/drivers/damaged_stream.h"
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

const char* const kVersion2 =
    "4958 02"                     // 'I' 'X', version 2
    "00000020 00000000"           // navigation block 5 (rotation rate); no external sensor
    "0025 00000005 00000123"      // 37 bytes, 500 µs, counter 291
    "40000000 BF800000 3F000000"  // 2, −1, 0.5 °/s
    "000002CF";
const char* const kVersion4 =
    "4958 04"
    "12004001 00000004 00000000"  // navigation blocks 0, 14, 25, 28; extended block 2; no external sensor
    "0038 0057"                   // 56 bytes of navigation blocks, 87 bytes in all
    "00012345 0001ABCD"           // 7.4565 s, counter 109517
    "41200000 3F800000 BF800000"  // attitude: 10, 1, −1 °
    "80000001 00000000"           // sensor status
    "41C80000 41D00000 41D80000"  // gyros 25 °C, accelerometers 26 °C, board 27 °C
    "3F800000 C0000000 411CE80A"  // 1, −2, 9.806650 m/s²
    "3E800000 BE000000 3D800000"  // 0.25, −0.125, 0.0625 °/s, Earth's rotation included
    "00000E87";

std::uint32_t sum(std::span<const std::uint8_t> bytes) {
  return std::accumulate(bytes.begin(), bytes.end(), 0U);
}

TEST(StdBin, Version2PackedByHand) {
  DriverInstance driver = make_driver("stdbin", {{"rate_block", "compensated"}});
  const ifog_sample s = one_sample(driver, hex_bytes(kVersion2));
  EXPECT_EQ(s.flags, unsigned{IFOG_SAMPLE_SEQUENCE | IFOG_SAMPLE_DEVICE_TIME});
  EXPECT_EQ(s.sequence, 0x123U);
  EXPECT_EQ(s.device_time_ns, 500'000);
  EXPECT_EQ(s.valid_axes, 7U);
  expect_numbers(s.value, {2.0 * kDegree, -1.0 * kDegree, 0.5 * kDegree});
  EXPECT_EQ(s.environment_fresh, 0U);
}

TEST(StdBin, Version4PackedByHand) {
  DriverInstance driver = make_driver("stdbin", {});
  const ifog_sample s = one_sample(driver, hex_bytes(kVersion4));
  EXPECT_EQ(s.sequence, 0xABCDU);  // of 0x1ABCD
  EXPECT_EQ(s.device_time_ns, 7'456'500'000);
  EXPECT_EQ(s.status, 0x80000001U);
  expect_numbers(s.value, {0.25 * kDegree, -0.125 * kDegree, 0.0625 * kDegree});
  EXPECT_EQ(s.environment_fresh, 0b111111U);
  expect_numbers(s.environment, {1.0, -2.0, static_cast<double>(9.80665F), 25.0, 26.0, 27.0});
}

TEST(StdBin, ATelegramWithoutTheWantedRateIsCounted) {
  DriverInstance driver = make_driver("stdbin", {{"rate_block", "raw"}});
  EXPECT_TRUE(decoded(driver, hex_bytes(kVersion2)).empty());
  EXPECT_EQ(driver.counters().frames_format, 1U);
  EXPECT_EQ(driver.counters().frames_good, 0U);
  EXPECT_EQ(driver.counters().bytes_framed, 37U);
}

// Masks and lengths that contradict each other are no header, whatever the sum says.
TEST(StdBin, AWrongLengthIsNoTelegram) {
  DriverInstance driver = make_driver("stdbin", {{"rate_block", "compensated"}});
  Bytes telegram = hex_bytes(kVersion2);
  telegram[6] = 0x21;  // and block 0
  telegram[36] = static_cast<std::uint8_t>(telegram[36] + 1);
  EXPECT_EQ(sum(std::span(telegram).first(33)), 0x2D0U);
  EXPECT_TRUE(decoded(driver, telegram).empty());
}

TEST(StdBin, TheTimeOfDayGoesRoundAtMidnight) {
  DriverInstance driver = make_driver("stdbin", {});
  ifog_sample sample{};
  sample.flags = IFOG_SAMPLE_DEVICE_TIME;
  sample.valid_axes = 7;
  Bytes bytes;
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  for (const std::int64_t time_ns : {kDay_ns - 10'000'000, kDay_ns, kDay_ns + 10'000'000}) {
    sample.device_time_ns = time_ns;
    driver.encode_bytes(sample, bytes);
  }
  const auto samples = decoded(driver, bytes, 0);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[0].device_time_ns, kDay_ns - 10'000'000);
  EXPECT_EQ(samples[1].device_time_ns, 0);
  EXPECT_EQ(samples[2].device_time_ns, 10'000'000);
  for (const ifog_sample& each : samples) EXPECT_EQ(each.device_wrap_ns, kDay_ns);
}

TEST(StdBin, EncodesEveryVersionSoThatItReadsBack) {
  for (const char* version : {"2", "3", "4", "5"}) {
    const std::string block = version[0] == '2' ? "compensated" : "raw";
    DriverInstance driver = make_driver("stdbin", {{"version", version}, {"rate_block", block}});
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_DEVICE_TIME | IFOG_SAMPLE_SEQUENCE;
    sample.sequence = 77;
    sample.device_time_ns = 1'234'500'000;
    sample.valid_axes = 0b101;
    sample.value[0] = 0.125;
    sample.value[2] = -0.5;
    for (double& each : sample.environment) each = std::nan("");
    sample.environment[3] = 30.5;
    Bytes bytes;
    driver.encode_bytes(sample, bytes);
    EXPECT_EQ(bytes[2], version[0] - '0');
    const ifog_sample s = one_sample(driver, bytes);
    EXPECT_EQ(s.sequence, 77U);
    EXPECT_EQ(s.device_time_ns, 1'234'500'000);
    EXPECT_EQ(s.valid_axes, 0b101U);
    EXPECT_NEAR(s.value[0], 0.125, 1e-8);
    EXPECT_NEAR(s.value[2], -0.5, 1e-7);
    EXPECT_EQ(s.environment_fresh, 0b1000U);
    EXPECT_EQ(s.environment[3], 30.5);
  }
  EXPECT_THROW(make_driver("stdbin", {{"version", "2"}}), std::runtime_error);
}

// The blocks' lengths once more, by hand from the protocol's tables.
constexpr unsigned kNavigation[] = {12, 12, 16, 8,  12, 12, 12, 21, 16, 12, 12, 8,  8,  4,  8, 16,
                                    12, 4,  4,  12, 4,  12, 12, 12, 8,  12, 16, 12, 12, 12, 12};
constexpr unsigned kExtended[] = {12, 12, 12, 12, 12, 21, 16};
constexpr unsigned kExternal[] = {5,  46, 46, 46, 13, 13, 49, 49, 49, 12, 37, 33, 8,  8,
                                  41, 41, 41, 41, 9,  9,  9,  37, 33, 0,  16, 17, 17, 12};

template <std::size_t kCount>
std::size_t length_of(std::uint32_t mask, const unsigned (&lengths)[kCount]) {
  std::size_t out = 0;
  for (std::size_t bit = 0; bit < kCount; ++bit) out += (mask >> bit & 1U) != 0 ? lengths[bit] : 0U;
  return out;
}

void number(Bytes& out, std::size_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
    out.push_back(static_cast<std::uint8_t>(value >> shift));
}

TEST(StdBin, EveryIntactTelegramComesOutOfADamagedStream) {
  Random random(9);
  std::vector<Bytes> telegrams(200);
  for (Bytes& out : telegrams) {
    const unsigned version = 2 + random() % 4;
    const std::uint32_t navigation = random() & random() & 0x7FFFFFFFU;
    const std::uint32_t extended = version > 2 ? random() & 0x7FU : 0;
    const std::uint32_t external = random() & random() & random() & 0x0F7FFFFFU;
    const std::size_t inner = length_of(navigation, kNavigation) + length_of(extended, kExtended);
    const std::size_t blocks = inner + length_of(external, kExternal);
    out = {'I', 'X', static_cast<std::uint8_t>(version)};
    number(out, navigation, 4);
    if (version > 2) number(out, extended, 4);
    number(out, external, 4);
    if (version > 3) number(out, inner, 2);
    number(out, out.size() + 10 + blocks + 4, 2);
    number(out, random(), 4);
    number(out, random(), 4);
    for (std::size_t i = 0; i < blocks; ++i)
      out.push_back(static_cast<std::uint8_t>(random() % 8 == 0 ? 'I' + 15 * (random() % 2) : random()));
    number(out, sum(out), 4);
  }
  every_intact_frame_comes_out(telegrams, 100, stdbin::Protocol{});
}

}  // namespace
}  // namespace ifog
